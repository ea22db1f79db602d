"""The runs of a campaign's seed scenarios, unchanged, as values."""

from __future__ import annotations

from dataclasses import dataclass

from drivora_service.oracles.verdict import Verdict
from drivora_service.runs.run_report import RunFailure, RunStatus
from drivora_service.shapes import Shape, adapter, to_json


@dataclass(frozen=True, slots=True, kw_only=True)
class SeedRun(Shape):
    """The run of a seed scenario as it is, which a campaign makes outside its budget.

    Attributes:
        place: Place of the seed scenario in the campaign, from 0.
        name: Its name in the campaign; empty if there is only one.
        run_id: Id of the run.
        status: How the run ended.
        failures: Verdicts that the campaign counts as failures.
        error: Why the run was not judged; null if it was.
        sim_time_s: Simulated seconds.
        wall_time_s: Seconds of the run in its worker.
    """

    place: int
    name: str
    run_id: str
    status: RunStatus
    failures: tuple[Verdict, ...] = ()
    error: RunFailure | None = None
    sim_time_s: float = 0.0
    wall_time_s: float = 0.0

    @property
    def ads_failed(self) -> bool:
        """Whether the ADS itself failed: it raised, hung, died or answered invalidly."""
        return self.status is RunStatus.AGENT_FAILED


def seed_runs_to_json(runs: tuple[SeedRun, ...]) -> str:
    """Writes the runs of a campaign's seeds as JSON text."""
    return to_json(tuple[SeedRun, ...], runs).decode()


def seed_runs_from_json(text: str) -> tuple[SeedRun, ...]:
    """Reads what :func:`seed_runs_to_json` has written."""
    if text == "[]":
        return ()
    runs: tuple[SeedRun, ...] = adapter(tuple[SeedRun, ...]).validate_json(text)
    return runs
