"""A minimisation at work: what its minimiser wants as runs, and what their reports answer."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.errors import TraceDamaged
from drivora_service.observations.trace_files.checked_trace import read_checked_trace
from drivora_service.observations.trace_files.stored_trace import StoredTrace
from drivora_service.runs.run_report import RunReport, RunStatus
from drivora_service.scenario.documents import parse_document
from drivora_service.scenario.model import AgentChoice
from drivora_service.store.minimizations.minimization_records import (
    MinimizationProgress,
    MinimizationState,
    ScenarioSize,
)
from drivora_service.store.minimizations.minimization_repository import ActiveMinimization
from drivora_service.store.runs.run_records import LONGEST_LABEL, NewRun
from drivora_service.suites.minimization.changed_software import Performed, changed_software
from drivora_service.suites.minimization.edits import content_of
from drivora_service.suites.minimization.later_starts import Recording, recording_of
from drivora_service.suites.minimization.minimizer import (
    Minimizer,
    Phase,
    Purpose,
    Trial,
    TrialResult,
)
from drivora_service.suites.minimization.proposal_checking import Checker
from drivora_service.suites.minimization.reduction_search import Reductions, State
from drivora_service.suites.minimization.scenario_sizes import differences, size_of
from drivora_service.suites.minimization.shortening import Failure

_WITHOUT_RESULT = (RunStatus.INFRASTRUCTURE_FAILED, RunStatus.CANCELLED)
_MOST_LOST = 3
"""Runs without a result after which a minimisation fails."""
_HASH = 14
"""Digits of a scenario's hash in the id of a run, which has 40 characters at most."""


@dataclass(frozen=True, slots=True, kw_only=True)
class End:
    """How a minimisation has ended.

    Attributes:
        message: Why it failed; "" if it did not.
    """

    state: MinimizationState
    message: str = ""


class Work:
    """One minimisation, between its minimiser and the queue.

    Attributes:
        id: Id of the minimisation.
        batch_id: Batch of its runs.
        waiting: Ids of the runs that have been queued and have not been answered.
    """

    def __init__(
        self,
        active: ActiveMinimization,
        checker: Checker,
        agents: AgentCatalogue,
        trace_path: Callable[[str], Path],
        *,
        original: Performed | None = None,
    ) -> None:
        """Creates the work, of which the reproduction of the failure is wanted first.

        Args:
            active: The minimisation as it is stored.
            checker: Checks the proposals.
            agents: The agents, for the defaults of their parameters.
            trace_path: Returns the path of a run's trace, by the run's id.
            original: The run that fails, with its versions; ``None``: it was removed.

        Raises:
            UnknownName: Its road network is not in the catalogue.
            ValueError: Its scenario cannot be run here.
        """
        self.id, self.batch_id = active.id, active.batch_id
        self.waiting: set[str] = set()
        self._run_id, self._identity = active.run_id, active.failure
        self._agents = agents
        self._original = original
        self._reproduction: RunReport | None = None
        self._trace_path = trace_path
        document = parse_document(active.document)
        self._network = checker.network_of(document)
        self._minimizer = Minimizer(
            document,
            check=checker,
            reductions=Reductions(ego=active.failure.ego, network=self._network),
            budget=active.budget,
        )
        self._results: dict[str, TrialResult] = {}
        self._simulation_s = 0.0
        self._lost = 0
        self._broken = ""
        self._size: tuple[State, ScenarioSize] | None = None
        self._before: ScenarioSize | None = None

    def resume(self, reports: Iterable[RunReport], waiting: Iterable[str]) -> None:
        """Restores the state from the runs of a process that has ended.

        Args:
            reports: Reports of its runs that have ended; those without a result are made again.
            waiting: Ids of the others, which count even if their results are not needed any more.
        """
        for report in reports:
            if report.status not in _WITHOUT_RESULT:
                self.take(report)
        self.waiting.update(waiting)

    def take(self, report: RunReport) -> None:
        """Takes the report of a run of this minimisation; each run is counted once."""
        self.waiting.discard(report.run_id)
        if report.run_id in self._results:
            return
        if report.status in _WITHOUT_RESULT:
            if self._minimizer.is_over:
                # It was made ahead, and is not needed.
                return
            self._lost += 1
            if self._lost >= _MOST_LOST:
                why = "" if report.failure is None else f": {report.failure.message}"
                self._broken = f"run {report.run_id} could not be performed{why}"
            return
        self._simulation_s += report.wall_time_s
        if report.run_id.endswith(Purpose.REPRODUCE):
            self._reproduction = report
        found = self._identity.find_in(report.verdicts)
        self._results[report.run_id] = TrialResult(
            failure=None
            if found is None
            else Failure(time=found.time, location=found.location, sim_time_s=report.sim_time_s),
            recording=self._read_recording(report) if found else None,
        )

    def choose_runs(self, most: int) -> tuple[NewRun, ...]:
        """Returns the runs to be queued next, so that at most so many are needed at once."""
        if self._broken:
            return ()
        while True:
            trials = {self._run_of(trial): trial for trial in self._minimizer.choose_trials(most)}
            known = [run_id for run_id in trials if run_id in self._results]
            if not known:
                break
            for run_id in known:
                self._minimizer.tell(trials[run_id].key, self._results[run_id])
        new = [run_id for run_id in trials if run_id not in self.waiting]
        return tuple(self._new_run(run_id, trials[run_id]) for run_id in new)

    @property
    def end(self) -> End | None:
        """How it has ended; ``None`` while it goes on, or runs are not counted yet."""
        if self._broken:
            return End(state=MinimizationState.FAILED, message=self._broken)
        if self.waiting:
            return None
        match self._minimizer.phase:
            case Phase.DONE:
                return End(state=MinimizationState.FINISHED)
            case Phase.NOT_REPRODUCED:
                return End(state=MinimizationState.FAILED, message=self._explain())
            case Phase.NOT_CONFIRMED:
                message = (
                    "the smallest scenario did not fail in the same way when it was run again: "
                    "the failure is flaky"
                )
                return End(state=MinimizationState.FAILED, message=message)
        return None

    @property
    def progress(self) -> MinimizationProgress:
        """How far it is."""
        minimizer, state = self._minimizer, self._minimizer.state
        if minimizer.original is None or state is None:
            return MinimizationProgress(
                stage=minimizer.phase,
                simulations=len(self._results),
                simulation_s=self._simulation_s,
            )
        if self._before is None:
            self._before = self._size_of(minimizer.original)
        if self._size is None or self._size[0] is not state:
            self._size = (state, self._size_of(state))
        is_done = minimizer.phase is Phase.DONE
        is_searching = minimizer.phase is Phase.SEARCHING
        return MinimizationProgress(
            stage=minimizer.stage if is_searching else minimizer.phase,
            decided=minimizer.decided,
            simulations=len(self._results),
            simulation_s=self._simulation_s,
            before=self._before,
            after=self._size[1],
            one_minimal=minimizer.is_one_minimal if is_done else None,
            reproduction_run_id=self._run_of(minimizer.reproduction),
            minimal_run_id=self._run_of(minimizer.confirmation) if is_done else "",
            removed=differences(minimizer.original.document, state.document, self._network),
            document={"version": "1.0", "frame": "sumo", **content_of(state.document)},
        )

    def _explain(self) -> str:
        """Returns why the failure may not have come again."""
        again = self._reproduction
        message = (
            f"the scenario of run {self._run_id} does not fail in the same way when it is run "
            f"again: {self._identity.oracle} of {self._identity.ego} was expected. "
        )
        if again is not None and again.failure is not None:
            status = again.status.replace("_", " ")
            return f"{message}The run ended as {status}: {again.failure.message}"
        if again is None or self._original is None or not self._original.versions:
            return f"{message}The failure is flaky, or the software has changed since"
        changes = changed_software(self._original, again)
        if not changes:
            return f"{message}No software has changed since: the failure is flaky"
        return f"{message}What has changed since: {'; '.join(changes)}"

    def _read_recording(self, report: RunReport) -> Recording | None:
        """Returns the motions of a run that was observed, unless its trace is gone or damaged."""
        run_id = report.run_id
        if not run_id.endswith(Purpose.OBSERVE):
            return None
        try:
            path = self._trace_path(run_id)
            stored = StoredTrace(run_id=run_id, path=path, sha256=report.trace_sha256)
            return recording_of(read_checked_trace(stored))
        except (TraceDamaged, OSError):
            # An OSError is of a storage that does not answer.
            return None

    def _size_of(self, state: State) -> ScenarioSize:
        return size_of(state.document, self._network, sim_time_s=state.failure.sim_time_s)

    def _run_of(self, trial: Trial) -> str:
        return f"{self.id}-{trial.checked.sha256[:_HASH]}{trial.purpose}"

    def _new_run(self, run_id: str, trial: Trial) -> NewRun:
        checked = trial.checked
        egos = checked.document.ego_vehicles
        agents = dict.fromkeys(ego.agent_name or "" for ego in egos)
        return NewRun(
            document=checked.text,
            scenario_sha256=checked.sha256,
            town=checked.document.map_region.town,
            agent=",".join(agents),
            configuration=self._agents.configuration(
                AgentChoice(name=ego.agent_name or "", parameters=ego.agent.parameters)
                if ego.agent is not None
                else AgentChoice(name=ego.agent_name or "")
                for ego in egos
            ),
            label=trial.label[:LONGEST_LABEL],
            item=len(self._results) + len(self.waiting),
            keeps_trace=trial.purpose is not Purpose.TRY,
            run_id=run_id,
        )
