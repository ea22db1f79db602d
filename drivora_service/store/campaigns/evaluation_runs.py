"""The runs of evaluations as runs, where the queue has none or recorded none.

A campaign of a command has no jobs, and a search records no run. What is known of an evaluation is
enough to show its run; a failure that was confirmed has the recording of its second, identical run.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from sqlalchemy import select
from sqlalchemy.orm import Session

from drivora_service.oracles.verdicts.failure_definition import (
    definition_of_document,
    state_definition,
)
from drivora_service.runs.report_encoding import report_from_json
from drivora_service.shapes import combine
from drivora_service.store.campaigns.campaign_records import Confirmation
from drivora_service.store.campaigns.campaign_repository import campaign_row
from drivora_service.store.campaigns.campaign_tables import EvaluationRow, FailureRow
from drivora_service.store.campaigns.evaluation_repository import evaluation_row
from drivora_service.store.campaigns.evaluation_writing import town_of_seed
from drivora_service.store.queue.endings import end_values
from drivora_service.store.runs.notable_verdicts import find_failing_verdicts
from drivora_service.store.runs.run_records import RunRecord

_RUN_ID = re.compile(r"(?P<campaign>[0-9a-f]{24})-(?P<number>\d{1,9})(-again)?")


@dataclass(frozen=True, slots=True)
class EvaluationId:
    """An evaluation.

    Attributes:
        campaign_id: Id of its campaign.
        number: Its number, from 0.
    """

    campaign_id: str
    number: int

    @property
    def run_id(self) -> str:
        """Id of its run."""
        return f"{self.campaign_id}-{self.number}"


def evaluation_of_run(run_id: str) -> EvaluationId | None:
    """Returns the evaluation that an id of a run names; ``None`` if it has another form."""
    found = _RUN_ID.fullmatch(run_id)
    if found is None:
        return None
    return EvaluationId(found["campaign"], int(found["number"]))


def run_of_evaluation(session: Session, wanted: EvaluationId) -> RunRecord:
    """Returns the run of an evaluation.

    Its ``trace_sha256`` is empty unless an identical run confirmed the failure and was recorded.

    Raises:
        UnknownName: There is no such campaign, or it has no such evaluation.
    """
    campaign = campaign_row(session, wanted.campaign_id)
    row = evaluation_row(session, campaign, wanted.number)
    report = report_from_json(row.report)
    definition = definition_of_document(campaign.document)
    values = end_values(
        report, definition, keeps_trace=_is_recorded(session, campaign.seq, row), ended=row.told_at
    )
    return combine(
        RunRecord,
        report,
        **values,
        id=wanted.run_id,
        campaign_id=campaign.id,
        evaluation=wanted.number,
        label=f"{campaign.name} #{wanted.number}",
        batch_id=campaign.batch_id or "",
        item=wanted.number,
        town=town_of_seed(campaign, row.seed_number),
        agent=campaign.agent,
        configuration=campaign.configuration,
        configuration_id=campaign.configuration_id,
        seed=None,
        scenario_sha256=row.document_sha256 or "",
        created_at=row.told_at,
        started_at=None,
        cancel_requested=False,
        attempts=1,
        revision=campaign.revision,
        error=report.failure,
        step_cost_us=report.step_cost_us if report.steps else None,
        simulation_sha256=report.trace_sha256,
        definition=state_definition((definition,)),
        failing_verdicts=find_failing_verdicts(report, definition),
    )


def _is_recorded(session: Session, campaign_seq: int, row: EvaluationRow) -> bool:
    found = session.execute(
        select(FailureRow.confirmation, FailureRow.trace).where(
            FailureRow.campaign_seq == campaign_seq, FailureRow.number == row.number
        )
    ).all()
    return any(
        confirmation == Confirmation.CONFIRMED and bool(trace) for confirmation, trace in found
    )
