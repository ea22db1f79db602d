"""Failures of all campaigns and batches, with their addresses."""

from __future__ import annotations

from dataclasses import dataclass
from urllib.parse import urlencode

from drivora_service.oracles.verdict import Verdict
from drivora_service.shapes import combine
from drivora_service.store.failures import failure_records


@dataclass(frozen=True, slots=True, kw_only=True)
class FoundFailure(failure_records.FoundFailure):
    """A failure of a campaign, or a violation that counts of a run outside campaigns.

    Attributes:
        run_url: Address of its run; empty if there is none any more.
        scenario_url: Address of its scenario.
        picture_url: Address of a picture of the moments that lead to it; empty if none can be
            drawn, because nothing is recorded.
    """

    run_url: str
    scenario_url: str
    picture_url: str


def found_failure_of(failure: failure_records.FoundFailure, base: str) -> FoundFailure:
    """Returns a failure with its addresses; ``base`` is the address of the API."""
    run = f"{base}/runs/{failure.run_id}"
    evaluation = f"{base}/campaigns/{failure.campaign_id}/evaluations/{failure.evaluation}"
    own = evaluation if failure.campaign_id else run
    return combine(
        FoundFailure,
        failure,
        run_url=run,
        scenario_url=f"{own}/scenario",
        picture_url=f"{own}/picture?{_query(failure.verdict)}" if failure.is_recorded else "",
    )


def _query(verdict: Verdict) -> str:
    """Returns the query of a picture that shows a violation, and not the gravest of its run."""
    parts = {"oracle": verdict.oracle, "ego": verdict.ego, "step": verdict.step}
    return urlencode({name: value for name, value in parts.items() if value is not None})
