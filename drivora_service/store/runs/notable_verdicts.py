"""The verdicts of a report that found something, which are stored in rows of their own."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from drivora_service.oracles.verdict import WITHOUT_FINDING, Outcome, Verdict
from drivora_service.oracles.verdicts.accountability import Accountability, accountability
from drivora_service.oracles.verdicts.failure_definition import (
    DEFAULT_DEFINITION,
    Counted,
    FailureDefinition,
)
from drivora_service.runs.run_report import RunReport, RunStatus


class NotableVerdict(NamedTuple):
    """A verdict that is violated or not measurable.

    Attributes:
        place: Its place in the report.
        verdict: The verdict.
        accountability: That of a violation, else ``None``.
        is_violation: Whether it is a violation of a finished run, no observation, and none that
            only follows from another one.
        is_counted: Whether it is a failure by the definition of its run.
    """

    place: int
    verdict: Verdict
    accountability: Accountability | None
    is_violation: bool
    is_counted: bool


_VIOLATIONS = FailureDefinition(counts=Counted.ANY)


def notable_verdicts(
    report: RunReport, definition: FailureDefinition = DEFAULT_DEFINITION
) -> Sequence[NotableVerdict]:
    """Returns the verdicts of a report that are violated or not measurable, in their order.

    Args:
        report: The report.
        definition: What counts as a failure of its run.
    """
    finished = report.status is RunStatus.FINISHED
    agents = agents_of_report(report)
    found = []
    for place, verdict in enumerate(report.verdicts):
        outcome = verdict.outcome
        if outcome in WITHOUT_FINDING:
            continue
        if outcome is Outcome.VIOLATED:
            is_violation = finished and _VIOLATIONS.is_failure(verdict)
            is_counted = finished and definition.is_failure(verdict, agents)
            degree = accountability(verdict)
            found.append(NotableVerdict(place, verdict, degree, is_violation, is_counted))
        else:
            found.append(NotableVerdict(place, verdict, None, False, False))
    return found


def count_failures_of(
    report: RunReport, definition: FailureDefinition, notable: Sequence[NotableVerdict]
) -> int | None:
    """Returns the number of failures of a run; ``None`` if it says nothing about its ADS.

    That the ADS itself failed is one.
    """
    if report.status is RunStatus.AGENT_FAILED:
        agents = agents_of_report(report)
        return int(not definition.knows(RunStatus.AGENT_FAILED, "", "", agents))
    if report.status is not RunStatus.FINISHED:
        return None
    return sum(one.is_counted for one in notable)


def find_failing_verdicts(report: RunReport, definition: FailureDefinition) -> tuple[int, ...]:
    """Returns the places of the failures among the verdicts of a report."""
    if report.status is not RunStatus.FINISHED:
        return ()
    agents = agents_of_report(report)
    return tuple(
        place
        for place, verdict in enumerate(report.verdicts)
        if definition.is_failure(verdict, agents)
    )


def agents_of_report(report: RunReport) -> dict[str, str]:
    """Returns the names of the ADSs of a run, by the ids of their egos."""
    return {ego: choice.name for ego, choice in report.agents.items()}
