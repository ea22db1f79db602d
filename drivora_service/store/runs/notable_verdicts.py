"""The verdicts of a report that did not pass, which are stored in rows of their own."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from drivora_service.oracles.verdict import Outcome, Severity, Verdict
from drivora_service.oracles.verdicts.accountability import Accountability, accountability
from drivora_service.runs.run_report import RunReport, RunStatus


class NotableVerdict(NamedTuple):
    """A verdict that is violated or not measurable.

    Attributes:
        place: Its place in the report.
        verdict: The verdict.
        accountability: That of a violation, else ``None``.
        is_failure: Whether it is a violation that counts: of a finished run, and no observation.
    """

    place: int
    verdict: Verdict
    accountability: Accountability | None
    is_failure: bool


def notable_verdicts(report: RunReport) -> Sequence[NotableVerdict]:
    """Returns the verdicts of a report that did not pass, in their order."""
    finished = report.status is RunStatus.FINISHED
    found = []
    for place, verdict in enumerate(report.verdicts):
        outcome = verdict.outcome
        if outcome is Outcome.PASSED:
            continue
        if outcome is Outcome.VIOLATED:
            counts = finished and verdict.severity is not Severity.OBSERVATION
            found.append(NotableVerdict(place, verdict, accountability(verdict), counts))
        else:
            found.append(NotableVerdict(place, verdict, None, False))
    return found
