"""What happened when in a run, for its time line: steps are rows of the trace, ends included."""

from __future__ import annotations

from pydantic import Field

from drivora_service.api.schemas.base import Schema
from drivora_service.observations.trace import Role, TerminalEvent
from drivora_service.oracles.verdict import Answer, Severity
from drivora_service.oracles.verdicts.accountability import Accountability


class StepSpan(Schema):
    """Steps from ``first`` to ``last``."""

    first: int
    last: int


class EgoPart(Schema):
    """An ego's part of a run."""

    row: int = Field(description="Row of the ego in the trace.")
    id: str
    agent: str = Field(description='Its agent; "" for runs of versions that did not record it.')
    first: int
    last: int = Field(description="Less than `first` if its part never began.")
    end: TerminalEvent
    privileged: bool = Field(description="Whether it bypassed the perception model.")
    route_length: float = Field(description="Metres.")


class ActorPresence(Schema):
    """The times of an actor in the world."""

    row: int
    id: str
    role: Role
    model: str
    length: float = Field(description="Metres.")
    width: float = Field(description="Metres.")
    present: tuple[StepSpan, ...]


class ViolationMark(Schema):
    """A violation and its moments."""

    number: int = Field(description="In order of time, from 1, as in pictures of the run.")
    oracle: str
    ego: str
    message: str = Field(description="One sentence.")
    severity: Severity
    at_fault: bool | None
    accountability: Accountability
    avoidable: Answer | None
    physically_avoidable: Answer | None
    counterpart: str = Field(description='Id of the other actor; "" if there is none.')
    location: tuple[float, float] | None = Field(description="Where it began, metres.")
    first: int | None = Field(description="Step in which it began; null for a run as a whole.")
    last: int | None = Field(description="Last step in which it went on; `first` for a moment.")
    risk_perceived: int | None = Field(
        description="Step from which on a careful driver perceives the risk; null: not measured."
    )
    avoidable_until: int | None = Field(
        description="Last step in which a careful driver could still avoid it; null: it could not, "
        "or this is not measured."
    )


class LightPhase(StepSpan):
    """Steps in which a signal showed a colour."""

    light: str = Field(description="none (off), green, yellow or red.")


class Approach(StepSpan):
    """Steps in which a signal was the next one on an ego's route."""

    ego: int = Field(description="Row of the ego.")
    passed: int | None = Field(description="Step in which its front passed the stop line, or null.")


class MetLight(Schema):
    """A signal that an ego met."""

    id: str = Field(description="The traffic light.")
    link: int = Field(description="Position of the signal in the light's states.")
    lane: str = Field(description="Lane before the stop line.")
    approaches: tuple[Approach, ...]
    phases: tuple[LightPhase, ...] = Field(description="Of the whole run.")


class LogLine(Schema):
    """A line of an agent's log."""

    step: int
    ego: str
    message: str


class Timeline(Schema):
    """What happened when in a run."""

    run_id: str
    network: str
    steps: int
    step_length: float = Field(description="Seconds between two steps.")
    duration: float = Field(description="Seconds from the first step to the last one.")
    egos: tuple[EgoPart, ...]
    actors: tuple[ActorPresence, ...] = Field(description="In the order of their rows.")
    violations: tuple[ViolationMark, ...]
    lights: tuple[MetLight, ...] = Field(description="Signals that egos met.")
    log: tuple[LogLine, ...] = Field(description="The first lines of the agents' logs.")
    log_lines: int = Field(description="Number of all lines.")
