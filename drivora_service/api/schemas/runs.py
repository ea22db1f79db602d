"""Runs: the results of jobs."""

from __future__ import annotations

from dataclasses import dataclass

from drivora_service.oracles.oracles_version import judged_by_current
from drivora_service.shapes import combine
from drivora_service.store.runs.run_records import RunRecord


@dataclass(frozen=True, slots=True, kw_only=True)
class Run(RunRecord):
    """A run and, once it has ended, its results.

    Attributes:
        observations_url: Address of its recording; empty if nothing was recorded.
        scenario_url: Address of its scenario.
        judged_by_other_oracles: Whether its verdicts were given by another version of
            the oracles than that of this installation, or by one that was not recorded.
    """

    observations_url: str
    scenario_url: str
    judged_by_other_oracles: bool = False


def run_of(run: RunRecord, base: str) -> Run:
    """Returns a run with its addresses; ``base`` is the address of the API."""
    url = f"{base}/runs/{run.id}"
    return combine(
        Run,
        run,
        observations_url=f"{url}/observations" if run.trace_sha256 else "",
        scenario_url=f"{url}/scenario",
        judged_by_other_oracles=bool(run.verdicts) and not judged_by_current(run.versions),
    )
