"""Validation on its own, and the state of the service."""

from __future__ import annotations

from pydantic import Field

from drivora_service.api.schemas.base import Schema


class Validation(Schema):
    """A scenario that can be run."""

    valid: bool
    town: str
    agents: tuple[str, ...]
    scenario_sha256: str
    notes: tuple[str, ...] = Field(description="What will happen that its author may not expect.")


class Health(Schema):
    """Whether the process is alive."""

    status: str
    version: str


class Check(Schema):
    """One thing that must work before requests are sent here."""

    name: str
    ok: bool
    detail: str


class Readiness(Schema):
    """Whether the service can take work."""

    ready: bool
    checks: tuple[Check, ...]
