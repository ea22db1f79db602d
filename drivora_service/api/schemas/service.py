"""Validation on its own, and the state of the service."""

from __future__ import annotations

from pydantic import Field

from drivora_service.api.schemas.base import Schema
from drivora_service.api.schemas.problems import ProblemItem
from drivora_service.scenario.models.actor_models import ActorKind


class Validation(Schema):
    """A scenario that can be run."""

    valid: bool
    town: str
    agents: tuple[str, ...]
    scenario_sha256: str
    notes: tuple[str, ...] = Field(description="Warnings.")


class InspectedActor(Schema):
    """An actor as it appears, and its way, in the road network's plane."""

    pointer: str = Field(description="JSON pointer to it.")
    id: str
    kind: ActorKind
    x: float = Field(description="Centre of its box at its start, metres.")
    y: float = Field(description="Centre of its box at its start, metres.")
    yaw: float = Field(description="Heading at its start, radians counter-clockwise from east.")
    length: float = Field(description="Metres.")
    width: float = Field(description="Metres.")
    path: tuple[tuple[float, float], ...] = Field(
        description="Its way, metres; empty if it stays or has none."
    )
    path_length: float = Field(description="Metres.")


class Inspection(Schema):
    """What an editor shows of a scenario while it is written."""

    valid: bool = Field(description="Whether it can be run.")
    town: str = Field(description="Its road network; empty if that is unknown.")
    problems: tuple[ProblemItem, ...]
    notes: tuple[str, ...] = Field(description="Warnings about a valid scenario.")
    actors: tuple[InspectedActor, ...] = Field(
        description="The actors that are well-formed; others are in the problems."
    )


class Health(Schema):
    """Whether the process is alive."""

    status: str
    version: str


class Check(Schema):
    """A condition of readiness."""

    name: str
    ok: bool
    detail: str


class Readiness(Schema):
    """Whether the service can take work."""

    ready: bool
    checks: tuple[Check, ...]
