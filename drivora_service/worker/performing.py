"""Performing a run in the worker process: simulate, judge, measure, report.

Whatever an agent or a document does, the result is a report.
"""

from __future__ import annotations

import time
import traceback
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache, partial
from importlib.metadata import version

import numpy as np

from drivora_service.adversaries.playing import Table, play
from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.agents.interface import Agent
from drivora_service.agents.sumo_driver import SumoDriver
from drivora_service.errors import (
    AgentError,
    InvalidDocument,
    NetworkError,
    PluginError,
    SearchError,
    SimulatorError,
    StoreError,
    UnknownName,
)
from drivora_service.feedback.objectives import score
from drivora_service.metrics.built_in_metrics import measure
from drivora_service.metrics.catalogue import MetricCatalogue
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import Trace
from drivora_service.observations.trace_files.trace_hash import egos_sha256, trace_sha256
from drivora_service.observations.trace_files.trace_storage import remove_stored, store_trace
from drivora_service.oracles.built_in import default_oracles, judge_all
from drivora_service.oracles.catalogue import OracleCatalogue
from drivora_service.oracles.oracles_version import ORACLES, oracles_version
from drivora_service.runs.run_report import RunFailure, RunReport, RunSpec, RunStatus
from drivora_service.scenario.canonical import from_canonical
from drivora_service.scenario.model import AgentChoice
from drivora_service.scenario.overrides import with_overrides
from drivora_service.simulation.episode import Episode
from drivora_service.simulation.episode_changes import changes_anything
from drivora_service.simulation.planning import plan_episode
from drivora_service.simulation.plans.episode_plan import EpisodePlan
from drivora_service.simulation.run_phase import BoardCell, RunPhase
from drivora_service.simulation.sumo import SUMO_ERRORS
from drivora_service.worker.candidate_preparing import space_of_candidates
from drivora_service.worker.integrity import describe_code_changes, snapshot_judging_code
from drivora_service.worker.interventions import leave_scenario
from drivora_service.worker.objective_measuring import make_measuring
from drivora_service.worker.plugin_judging import judge_by_plugins
from drivora_service.worker.progress_board import ProgressBoard
from drivora_service.worker.setup import WorkerSetup
from drivora_service.worker.without_effect import genes_without_effect
from drivora_service.worker.worker_catalogues import (
    agents_of,
    metrics_of,
    networks_of,
    oracles_of,
)

_LOG_LINES = 12
"""Number of traceback entries that are kept."""


@lru_cache(maxsize=1)
def _versions() -> dict[str, str]:
    packages = {name: version(name) for name in ("drivora", "libsumo", "numpy", "numba")}
    return {**packages, ORACLES: oracles_version()}


@dataclass(slots=True)
class _Course:
    """Data on a run before its report.

    Attributes:
        started: Wall time at its start, seconds.
        stepping: Wall time of its steps, seconds.
        versions: Versions of the software that takes part, by name.
        agents: As in the report.
    """

    started: float
    versions: Mapping[str, str]
    agents: Mapping[str, AgentChoice] = field(default_factory=dict)
    stepping: float = 0.0


def perform(spec: RunSpec, setup: WorkerSetup, board: ProgressBoard | None = None) -> RunReport:
    """Performs one run.

    Args:
        spec: The run; its document is the canonical JSON of a validated scenario.
        setup: Set-up of the worker.
        board: Board for its progress.

    Returns:
        The report: finished, agent failed, plug-in failed, or invalid.

    Raises:
        SimulatorError: SUMO itself fails; the slot records it as a crash.
    """
    cells = np.zeros(len(BoardCell), dtype=np.int64) if board is None else board.cells
    cells[BoardCell.RUN] += 1
    cells[[BoardCell.STEP, BoardCell.EGO, BoardCell.IN_PROCESS]] = 0
    cells[BoardCell.PHASE] = RunPhase.PREPARING
    course = _Course(started=time.perf_counter(), versions=_versions())
    try:
        return _perform(spec, setup, board, cells, course)
    except AgentError as error:
        failure = RunFailure(cause=error.cause, message=str(error), log=error.log)
        # No error of the ADS is known; another attempt may succeed.
        killed = error.cause == "agent_killed"
        status = RunStatus.INFRASTRUCTURE_FAILED if killed else RunStatus.AGENT_FAILED
        return _make_failed_report(spec, status, failure, course)
    except PluginError as error:
        return _make_failed_report(spec, RunStatus.PLUGIN_FAILED, _plugin_failure(error), course)
    except SUMO_ERRORS as error:
        raise SimulatorError(f"SUMO refused a call: {error}") from error
    except (InvalidDocument, NetworkError, SearchError, UnknownName) as error:
        failure = RunFailure(cause="invalid_document", message=str(error))
        return _make_failed_report(spec, RunStatus.INVALID, failure, course)
    except Exception as error:
        # An error of this package's code, which an agent may have caused.
        if not (changes := snapshot_judging_code().changes()):
            raise
        log = "".join(traceback.format_exception(error)[-_LOG_LINES:])
        changed = _make_agent_error(changes, course, log)
        failure = RunFailure(cause=changed.cause, message=str(changed), log=log)
        return _make_failed_report(spec, RunStatus.AGENT_FAILED, failure, course)
    finally:
        cells[BoardCell.PHASE] = RunPhase.IDLE


def _perform(
    spec: RunSpec,
    setup: WorkerSetup,
    board: ProgressBoard | None,
    cells: np.ndarray[tuple[int], np.dtype[np.int64]],
    course: _Course,
) -> RunReport:
    code = snapshot_judging_code()
    # An oracle that cannot be loaded is found before a simulation is spent on it.
    oracles = oracles_of(setup)
    laws = oracles.laws()
    installed = oracles.load_installed() if setup.installed_oracles else ()
    metrics = metrics_of(setup).load_installed() if setup.installed_oracles else ()
    scenario = with_overrides(from_canonical(spec.document), agent=spec.agent, seed=spec.seed)
    network = networks_of(setup).get(scenario.map_region.town)
    plan = plan_episode(scenario, network)
    catalogue = agents_of(setup)
    catalogue.begin_run()
    egos = (ego.agent.name for ego in scenario.ego_vehicles)
    course.versions = {**course.versions, **_versions_of(catalogue, egos)}
    names = (*(law.name for law in laws), *(oracle.name for oracle in installed))
    course.versions = {**course.versions, **_versions_of(oracles, names)}
    measured_by = (metric.name for metric in metrics)
    course.versions = {**course.versions, **_versions_of(metrics_of(setup), measured_by)}
    course.agents = {ego.id: catalogue.fill_defaults(ego.agent) for ego in scenario.ego_vehicles}
    cells[BoardCell.IN_PROCESS] = any(
        catalogue.is_in_process(ego.agent.name) for ego in scenario.ego_vehicles
    )
    agents = [catalogue.create(e.agent.name, e.agent.parameters) for e in scenario.ego_vehicles]
    measuring = (
        None
        if spec.feedback is None
        else make_measuring(spec.feedback, tuple(judge.law for judge in laws))
    )
    adversary = None if spec.candidate is None else spec.candidate.adversary
    has_guests = any(catalogue.may_read_sumo(e.agent.name) for e in scenario.ego_vehicles)
    code.has_met_others |= has_guests
    episode = Episode(
        plan,
        agents,
        privileged=[catalogue.entry(e.agent.name).privileged for e in scenario.ego_vehicles],
        cells=cells,
        mirrored=has_guests,
        holding=adversary is None,
    )
    cells[BoardCell.PHASE] = RunPhase.SIMULATING
    begun = time.perf_counter()
    tables: Mapping[str, Table] = {}
    if adversary is None:
        while not episode.done:
            episode.step()
        trace = episode.finish()
    else:
        played = play(episode, adversary, partial(leave_scenario, board, spec))
        trace, tables = played.trace, played.tables
    course.stepping = time.perf_counter() - begun
    cells[BoardCell.PHASE] = RunPhase.JUDGING
    if changes := code.changes():
        raise _make_agent_error(changes, course)
    trace.meta["versions"] = course.versions
    trace.meta["agents"] = {
        ego: {"name": agent.name, "parameters": dict(agent.parameters)}
        for ego, agent in course.agents.items()
    }
    if spec.trace_path:
        try:
            store_trace(trace, spec.trace_path)
        except (OSError, StoreError) as error:
            failure = RunFailure(cause="trace_not_written", message=str(error))
            return _make_failed_report(spec, RunStatus.INFRASTRUCTURE_FAILED, failure, course)
    steps = max(trace.step_count - 1, 1)
    view = RunView(trace, network)
    verdicts = judge_all(trace, network, (*default_oracles(), *laws), view=view)
    report = RunReport(
        run_id=spec.run_id,
        status=RunStatus.FINISHED,
        verdicts=verdicts,
        metrics=measure(trace, network, verdicts, view=view),
        scores=score(trace, network, view=view),
        trace_sha256=trace_sha256(trace),
        egos_sha256=egos_sha256(trace),
        without_effect=_without_effect(
            spec, setup, plan, trace, is_bounded=not has_guests and _is_bounded(plan, agents, trace)
        ),
        steps=trace.step_count,
        sim_time_s=float(trace.times[-1]),
        wall_time_s=time.perf_counter() - course.started,
        step_cost_us=1e6 * course.stepping / steps,
        agent_cost_us={ego: 1e6 * spent / steps for ego, spent in episode.agent_seconds().items()},
        privileged=tuple(
            ego.id
            for ego, sees_all in zip(scenario.ego_vehicles, trace.privileged, strict=True)
            if sees_all
        ),
        agents=course.agents,
        versions=course.versions,
    )
    if not networks_of(setup).is_current(network):
        return _discard_result(spec, network, course)
    # Code that only this package has run in the process does not change while it judges.
    if code.has_met_others and (changes := code.changes()):
        raise _make_agent_error(changes, course)
    if measuring is None and not installed and not metrics:
        return report
    is_foreign = installed or metrics or (measuring is not None and not measuring.is_built_in)
    code.has_met_others |= bool(is_foreign)
    try:
        # Last, so that code of plug-ins cannot change the input of the others.
        report = judge_by_plugins(
            report, view, oracles=installed, metrics=metrics, measuring=measuring, tables=tables
        )
        if changes := code.changes():
            raise PluginError(
                describe_code_changes(changes, "an oracle, a metric or a feedback"),
                cause="plugin_changed_service",
            )
    except PluginError as error:
        return _make_unjudged_report(report, error)
    return replace(report, wall_time_s=time.perf_counter() - course.started)


def _discard_result(spec: RunSpec, network: RoadNetwork, course: _Course) -> RunReport:
    """Returns a report without a result: SUMO and the oracles may have read different files."""
    if spec.trace_path:
        remove_stored(spec.trace_path)
    message = f"the road network {network.name!r} was replaced while the run was executed"
    failure = RunFailure(cause="network_replaced", message=message)
    return _make_failed_report(spec, RunStatus.INFRASTRUCTURE_FAILED, failure, course)


def _without_effect(
    spec: RunSpec, setup: WorkerSetup, plan: EpisodePlan, trace: Trace, *, is_bounded: bool
) -> tuple[int, ...]:
    """Returns the genes without an effect; none if the document was not made of genes alone."""
    if spec.candidate is None or spec.candidate.adversary is not None:
        return ()
    space = space_of_candidates(spec.candidate.space, setup)
    values = np.array(spec.candidate.values)
    return genes_without_effect(space, values, plan, trace, is_bounded=is_bounded)


def _is_bounded(plan: EpisodePlan, agents: Sequence[Agent | SumoDriver], trace: Trace) -> bool:
    """Returns whether agents perceive only what is near, and SUMO drives no actor.

    Neither is known of an episode that changes while it runs.
    """
    flow = plan.scenario.background_traffic
    return not (
        plan.driven
        or changes_anything(plan.scenario)
        or (flow is not None and flow.count)
        or any(trace.privileged)
        or any(isinstance(agent, SumoDriver) for agent in agents)
    )


def _versions_of(
    catalogue: AgentCatalogue | OracleCatalogue | MetricCatalogue, names: Iterable[str]
) -> dict[str, str]:
    found: dict[str, str] = {}
    for name in names:
        found |= catalogue.versions(name)
    return found


def _make_agent_error(changes: tuple[str, ...], course: _Course, log: str = "") -> AgentError:
    names = sorted({choice.name for choice in course.agents.values()})
    by = f"the {'agent' if len(names) == 1 else 'agents'} {', '.join(map(repr, names))}"
    return AgentError(describe_code_changes(changes, by), cause="agent_changed_service", log=log)


def _make_unjudged_report(report: RunReport, error: PluginError) -> RunReport:
    """Returns a report without the judgement; the recording stays for inspection."""
    return replace(
        report,
        status=RunStatus.PLUGIN_FAILED,
        verdicts=(),
        metrics={},
        scores={},
        measurement=None,
        failure=_plugin_failure(error),
    )


def _plugin_failure(error: PluginError) -> RunFailure:
    return RunFailure(cause=error.cause, message=str(error), log=error.log)


def _make_failed_report(
    spec: RunSpec, status: RunStatus, failure: RunFailure, course: _Course
) -> RunReport:
    return RunReport(
        run_id=spec.run_id,
        status=status,
        failure=failure,
        wall_time_s=time.perf_counter() - course.started,
        agents=course.agents,
        versions=course.versions,
    )
