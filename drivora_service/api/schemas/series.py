"""Values of an ego by step."""

from __future__ import annotations

from pydantic import Field

from drivora_service.api.schemas.base import Schema


class SeriesColumnHead(Schema):
    """What a column of a series is."""

    name: str
    unit: str = Field(description='"" for numbers without one.')
    description: str


class SeriesHead(Schema):
    """What a series is of; with Arrow, the metadata `drivora_series` of the schema."""

    run_id: str
    ego: str
    row: int = Field(description="Row of the ego in the trace.")
    lanes: dict[int, str] = Field(description="SUMO's ids of the lanes by their index.")
    actors: tuple[str, ...] = Field(description="Ids of all actors in the order of their rows.")
    columns: tuple[SeriesColumnHead, ...]


class Series(SeriesHead):
    """Values of an ego by step, from the first to the last step of its part."""

    values: dict[str, tuple[int | float | None, ...]] = Field(
        description="By the names of the columns; null where a value is missing."
    )
