"""What an ego perceived against what was there."""

from __future__ import annotations

from pydantic import Field

from drivora_service.api.schemas.base import Schema


class Sensor(Schema):
    """The sensor of an ego, by the weather of the run."""

    range: float | None = Field(description="Metres; null: unlimited.")
    position_noise: float = Field(description="Standard deviation of x and of y, metres.")
    speed_noise: float = Field(description="Standard deviation of vx and of vy, m/s.")
    dropout: float = Field(description="Probability that an actor is missed at a step.")
    latency_steps: int = Field(description="Steps by which what is perceived is older.")
    hides: bool = Field(description="Whether actors hide one another.")


class PerceptionHead(Schema):
    """What a perception is of; with Arrow, the metadata `drivora_perception` of the schema."""

    run_id: str
    ego: str
    row: int = Field(description="Row of the ego in the trace.")
    privileged: bool = Field(description="Whether it bypassed the perception model.")
    sensor: Sensor
    sights: tuple[str, ...] = Field(
        description="Meaning of the column `sight` by its value: absent, perceived, or why not."
    )


class Perception(PerceptionHead):
    """How many actors an ego perceived by step, while its agent was asked."""

    first: int = Field(description="Step of the first numbers.")
    present: tuple[int, ...] = Field(description="Other actors in the world.")
    counts: dict[str, tuple[int, ...]] = Field(
        description="Of them by sight, by step; `absent`: those that were not yet there when the "
        "frame that is perceived was taken."
    )
