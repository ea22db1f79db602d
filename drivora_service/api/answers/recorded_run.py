"""A run with its recording and its road network, for answers that are computed from them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from drivora_service.api.answers.run_lookup import find_document, find_run
from drivora_service.api.context import ApiContext
from drivora_service.campaigns.search.confirmation import trace_name
from drivora_service.errors import Conflict, UnknownName
from drivora_service.store.campaigns.evaluation_runs import evaluation_of_run
from drivora_service.store.runs.run_records import RunRecord

if TYPE_CHECKING:
    from drivora_service.observations.run_view import EgoView, RunView
    from drivora_service.scenario.model import Scenario


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordedRun:
    """A run whose recording exists.

    Attributes:
        record: The run.
        path: Its trace file.
    """

    record: RunRecord
    path: Path

    @property
    def state(self) -> str:
        """Text that changes with the recording and with the results."""
        return f"{self.record.trace_sha256} {self.record.revision}"


def find_recorded_run(context: ApiContext, run_id: str) -> RecordedRun:
    """Returns a run with its recording.

    A failure that a campaign found is shown by the recording of its second, identical run.

    Raises:
        UnknownName: There is no such run, or it recorded nothing, or its trace was removed.
    """
    evaluation = evaluation_of_run(run_id)
    with context.database.read() as transaction:
        record = find_run(transaction, run_id)
    path = context.trace_path(record.id)
    if record.trace_sha256 and path.is_file():
        return RecordedRun(record=record, path=path)
    if evaluation is not None and record.trace_sha256:
        folder = context.campaign_folder(evaluation.campaign_id)
        path = folder.trace(trace_name(evaluation.number))
        if path.is_file():
            return RecordedRun(record=record, path=path)
    hint = f"the run is {record.status.value}"
    if evaluation is not None:
        hint += "; of the runs of a campaign, failures that were confirmed have a recording"
    raise UnknownName("trace", run_id, (), hint)


def view_of(context: ApiContext, run: RecordedRun) -> RunView:
    """Reads the recording of a run, and returns it as oracles see it.

    Raises:
        Conflict: Its road network has changed since.
        UnknownName: Its road network is not in the catalogue.
        StoreError: Its trace is damaged.
    """
    from drivora_service.observations.run_view import RunView
    from drivora_service.observations.trace_files.trace_file import read_trace

    trace = read_trace(run.path)
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
