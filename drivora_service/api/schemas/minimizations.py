"""Minimisations of failing runs."""

from __future__ import annotations

from dataclasses import dataclass

from pydantic import Field

from drivora_service.api.schemas.base import Schema
from drivora_service.oracles.verdicts.failure_identity import DEFAULT_RADIUS_M
from drivora_service.shapes import combine
from drivora_service.store.minimizations.minimization_records import MinimizationRecord
from drivora_service.suites.minimization.starting import DEFAULT_BUDGET


class MinimizationRequest(Schema):
    """How a run is to be minimised."""

    oracle: str = Field(
        "",
        max_length=60,
        description="Oracle whose violation is followed. Without it the gravest of the run: at "
        "fault before others, collisions before others of the same severity, then the earliest.",
    )
    radius_m: float = Field(
        DEFAULT_RADIUS_M,
        gt=0.0,
        le=1e6,
        allow_inf_nan=False,
        description="Metres within which a violation is at the same place.",
    )
    budget: int = Field(
        DEFAULT_BUDGET, ge=1, le=100_000, description="Simulations that the search may need."
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Minimization(MinimizationRecord):
    """A minimisation with its result.

    Attributes:
        batch_url: Address of the batch of its runs.
        reproduction_url: Address of the recorded run of the scenario as it was; empty before its
            end.
        minimal_run_url: Address of the recorded run of the smallest scenario; empty before its
            end.
    """

    batch_url: str
    reproduction_url: str
    minimal_run_url: str


def minimization_of(record: MinimizationRecord, base: str) -> Minimization:
    """Returns a minimisation with its addresses; ``base`` is the address of the API."""
    return combine(
        Minimization,
        record,
        batch_url=f"{base}/batches/{record.batch_id}",
        reproduction_url=_run_url(base, record.reproduction_run_id),
        minimal_run_url=_run_url(base, record.minimal_run_id),
    )


def _run_url(base: str, run_id: str) -> str:
    return f"{base}/runs/{run_id}" if run_id else ""
