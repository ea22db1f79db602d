"""From the report of a run to the evaluation that a tester receives."""

from __future__ import annotations

import math

from drivora_service.campaigns.evaluator import Answer
from drivora_service.errors import CampaignError
from drivora_service.oracles.verdict import Verdict
from drivora_service.oracles.verdicts.failure_definition import FailureDefinition
from drivora_service.runs.run_report import RunReport, RunStatus
from drivora_service.search.tester import Evaluation, EvaluationStatus
from drivora_service.store.campaigns.campaign_records import EvaluationRecord


def status_of(report: RunReport) -> EvaluationStatus:
    """Returns the status of the evaluation of a simulated run."""
    if report.status is RunStatus.FINISHED:
        return EvaluationStatus.JUDGED
    return EvaluationStatus.FAILED


def refuse_lost(answer: Answer) -> None:
    """Refuses a report without a result of the candidate, which must not affect the search.

    Raises:
        CampaignError: The workers were lost repeatedly, or the run was cancelled.
    """
    report = answer.report
    if report.status in (RunStatus.INFRASTRUCTURE_FAILED, RunStatus.CANCELLED):
        why = "" if report.failure is None else f": {report.failure.message}"
        raise CampaignError(
            f"evaluation {answer.number} was lost ({report.status}){why}. Resume the campaign to "
            "try it again"
        )


def violations_of(report: RunReport, definition: FailureDefinition) -> tuple[Verdict, ...]:
    """Returns the verdicts that count as failures, in the order of their times."""
    found = definition.failures(report.verdicts)
    return tuple(sorted(found, key=lambda v: math.inf if v.time is None else v.time))


def evaluation_of(record: EvaluationRecord) -> Evaluation:
    """Returns the evaluation that a tester receives."""
    judged = record.status is EvaluationStatus.JUDGED
    return Evaluation(
        number=record.number,
        proposal=record.proposal,
        status=record.status,
        violations=record.violations,
        verdicts=record.report.verdicts if judged else (),
        scores=record.report.scores if judged else {},
        measurement=record.report.measurement if judged else None,
        without_effect=record.report.without_effect if judged else (),
    )
