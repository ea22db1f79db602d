"""A run with its recording and its road network, for answers that are computed from them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from http import HTTPStatus
from typing import TYPE_CHECKING

import structlog

from drivora_service.api.answers.run_lookup import find_document, find_run
from drivora_service.api.context import ApiContext
from drivora_service.api.problem_details import ApiError
from drivora_service.campaigns.search.confirmation import trace_name
from drivora_service.errors import Conflict, UnknownName
from drivora_service.observations.trace_files.stored_trace import (
    StoredTrace,
    find_file,
    make_missing_error,
)
from drivora_service.store.campaigns.evaluation_runs import EvaluationId, evaluation_of_run
from drivora_service.store.runs.run_records import RunRecord

if TYPE_CHECKING:
    from drivora_service.observations.run_view import EgoView, RunView
    from drivora_service.scenario.model import Scenario


_RETRY_S = "10"

_log = structlog.stdlib.get_logger(__name__)


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordedRun:
    """A run whose recording exists.

    Attributes:
        record: The run.
        trace: Its trace file.
    """

    record: RunRecord
    trace: StoredTrace

    @property
    def state(self) -> str:
        """Text that changes with the recording and with the results."""
        return f"{self.record.trace_sha256} {self.record.revision}"


def find_recorded_run(context: ApiContext, run_id: str) -> RecordedRun:
    """Returns a run with its recording.

    A failure that a campaign found is shown by the recording of its second, identical run.

    Raises:
        UnknownName: There is no such run, or it recorded nothing, or its trace was removed.
        TraceDamaged: It recorded a trace, whose file is missing.
        ApiError: The storage of traces does not answer (503).
    """
    evaluation = evaluation_of_run(run_id)
    with context.database.read() as transaction:
        record = find_run(transaction, run_id)
    if not record.trace_sha256:
        hint = f"the run is {record.status.value}"
        if evaluation is not None:
            hint += "; of the runs of a campaign, failures that were confirmed have a recording"
        raise UnknownName("trace", run_id, (), hint)
    with _storage_answers(record.id):
        path = context.trace_path(record.id)
        if evaluation is not None and find_file(path).is_missing:
            folder = context.campaign_folder(evaluation.campaign_id)
            path = folder.trace(trace_name(evaluation.number))
    stored = StoredTrace(run_id=record.id, path=path, sha256=record.trace_sha256)
    return _recorded(record, stored)


def _recorded(record: RunRecord, stored: StoredTrace) -> RecordedRun:
    # What else may be wrong with the file is found when it is read.
    if find_file(stored.path).is_missing:
        raise make_missing_error(stored)
    return RecordedRun(record=record, trace=stored)


@contextmanager
def _storage_answers(run_id: str) -> Iterator[None]:
    """Answers with 503 if the storage of traces does not answer."""
    try:
        yield
    except OSError as error:
        _log.warning("trace_storage_failed", run=run_id, error=str(error))
        raise ApiError(
            HTTPStatus.SERVICE_UNAVAILABLE,
            f"run {run_id}: its trace cannot be fetched now: the storage of traces does not "
            "answer; ask again later. The log of the service has its error",
            headers={"Retry-After": _RETRY_S},
        ) from error


def find_recorded_evaluation(context: ApiContext, evaluation: EvaluationId) -> RecordedRun:
    """Returns the run of an evaluation, with the recording of its second, identical run.

    The second run of a flaky failure drove otherwise: its recording is not the evaluation's.

    Raises:
        UnknownName: There is no such evaluation, or no second run confirmed its failure.
        TraceDamaged: It recorded a trace, whose file is missing.
    """
    number = evaluation.number
    with context.database.read() as transaction:
        record = transaction.campaign_views.run(evaluation)
    if not record.trace_sha256:
        hint = "only failures that an identical second run confirmed have one"
        raise UnknownName("trace of evaluation", str(number), (), hint)
    with _storage_answers(record.id):
        path = context.campaign_folder(evaluation.campaign_id).trace(trace_name(number))
    return _recorded(record, StoredTrace(run_id=record.id, path=path, sha256=record.trace_sha256))


def view_of(context: ApiContext, run: RecordedRun) -> RunView:
    """Reads the recording of a run, and returns it as oracles see it.

    Raises:
        Conflict: Its road network has changed since.
        UnknownName: Its road network is not in the catalogue.
        TraceDamaged: The file is not the trace that was recorded.
    """
    from drivora_service.observations.run_view import RunView
    from drivora_service.observations.trace_files.checked_trace import read_checked_trace

    trace = read_checked_trace(run.trace)
    network = context.networks.get(trace.network)
    if network.sha256 != trace.network_sha256:
        raise Conflict(
            f"run {run.record.id!r} was recorded on another version of the road network "
            f"{trace.network!r}: run it again"
        )
    return RunView(trace, network)


def ego_of(view: RunView, row: int) -> EgoView:
    """Returns an ego of a run by its row.

    Raises:
        UnknownName: The run has no such ego.
    """
    if not 0 <= row < len(view.egos):
        raise UnknownName("ego", str(row), tuple(str(ego.row) for ego in view.egos))
    return view.egos[row]


def scenario_of(context: ApiContext, run: RecordedRun) -> Scenario:
    """Returns the scenario of a run."""
    from drivora_service.scenario.canonical import from_canonical

    with context.database.read() as transaction:
        return from_canonical(find_document(transaction, run.record.id))


def is_driven_by_sumo(context: ApiContext, run: RecordedRun, ego: EgoView) -> bool:
    """Returns whether SUMO drove an ego; an agent that is no longer installed is none of SUMO's."""
    choice = run.record.agents.get(ego.id)
    try:
        return choice is not None and context.agents.is_sumo_driver(choice.name)
    except UnknownName:
        return False
