"""Which verdicts of a report have rows of their own."""

from __future__ import annotations

from drivora_service.oracles.verdict import Outcome, Verdict
from drivora_service.runs.run_report import RunReport, RunStatus
from drivora_service.store.runs.notable_verdicts import notable_verdicts


def test_verdicts_without_a_finding_have_no_rows() -> None:
    verdicts = tuple(
        Verdict(oracle=f"oracle_{place}", ego="ego", outcome=outcome, message="m")
        for place, outcome in enumerate(Outcome)
    )
    report = RunReport(run_id="0" * 24, status=RunStatus.FINISHED, verdicts=verdicts)
    assert [(one.place, one.verdict.outcome) for one in notable_verdicts(report)] == [
        (1, Outcome.VIOLATED),
        (3, Outcome.NOT_MEASURABLE),
    ]
