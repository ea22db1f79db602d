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
    notes: tuple[str, ...] = Field(description="Warnings.")


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
