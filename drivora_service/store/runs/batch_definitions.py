"""What counts as a failure of the runs of a batch."""

from __future__ import annotations

from sqlalchemy import select
from sqlalchemy.orm import Session

from drivora_service.oracles.verdicts.failure_definition import (
    StatedDefinition,
    definition_from_json,
    state_definition,
)
from drivora_service.store.runs.run_tables import BatchRow, RunRow

_MOST_DEFINITIONS = 100
"""Different definitions of the runs of a batch that are looked at."""


def definition_of_batch(session: Session, batch_id: str) -> StatedDefinition:
    """Returns what counts as a failure of the runs of a batch; it reads all of them."""
    query = (
        select(RunRow.definition)
        .join(BatchRow, BatchRow.seq == RunRow.batch_seq)
        .where(BatchRow.id == batch_id)
        .distinct()
        .order_by(RunRow.definition)
        .limit(_MOST_DEFINITIONS)
    )
    return state_definition(map(definition_from_json, session.scalars(query)))
