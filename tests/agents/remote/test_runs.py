"""Runs with ADSs in real processes: those that drive, and each way to fail."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.agents.sumo_driver import SumoDriver
from drivora_service.networks.catalogue import shipped_networks
from drivora_service.observations.trace import Trace
from drivora_service.observations.trace_files.trace_hash import trace_sha256
from drivora_service.runs.run_report import RunFailure, RunReport, RunSpec, RunStatus
from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.model import Scenario
from drivora_service.worker import performing, worker_catalogues
from drivora_service.worker.setup import WorkerSetup
from tests.agents.remote.ads import FAULT_STEP
from tests.agents.remote.folders import add_agent, processes_with, wait_until
from tests.simulation.episodes import ego, place, run, scenario

Perform = Callable[..., RunReport]

START, END = place("harbour_1_0", 20), place("harbour_1_0", 120)


@pytest.fixture
def agents(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder of agents; what they leave behind would be in ``tmp_path / "temporary"``."""
    # Not in the test's own folder, whose path may be too long for a socket.
    with tempfile.TemporaryDirectory() as temporary:
        (tmp_path / "temporary").symlink_to(temporary)
        with monkeypatch.context() as patch:
            patch.setattr(tempfile, "tempdir", temporary)
            yield tmp_path / "agents"


@pytest.fixture
def catalogue(agents: Path) -> Iterator[AgentCatalogue]:
    made = AgentCatalogue(folder=agents)
    yield made
    made.close()


@pytest.fixture
def perform(agents: Path) -> Iterator[Perform]:
    """Performs a run as a worker does."""
    setup = WorkerSetup(shipped_networks=shipped_networks(), agents=agents)
    worker_catalogues.agents_of.cache_clear()

    def perform_run(what: Scenario) -> RunReport:
        return performing.perform(RunSpec(run_id="run", document=canonical_json(what)), setup)

    yield perform_run
    worker_catalogues.agents_of(setup).close()
    worker_catalogues.agents_of.cache_clear()
    assert left_behind(agents) == []


def left_behind(agents: Path) -> list[str]:
    """Processes and files of ADSs that are there although all were ended."""
    processes = [process.info["name"] for process in processes_with([str(agents)])]
    return processes + [path.name for path in (agents.parent / "temporary").iterdir()]


def one_ego(agent: str, seconds: float = 2.0) -> Scenario:
    return scenario(ego(START, END, agent=agent), seconds=seconds)


def drive(catalogue: AgentCatalogue, name: str) -> Trace:
    catalogue.begin_run()
    agent = catalogue.create(name, {})
    assert not isinstance(agent, SumoDriver)
    return run(one_ego(name), agent)


def failure_of(report: RunReport) -> RunFailure:
    assert report.status is RunStatus.AGENT_FAILED, report
    assert report.failure is not None
    return report.failure


@pytest.mark.parametrize("control", ["acceleration", "pedals", "pose", "trajectory"])
def test_every_control_is_understood(agents: Path, catalogue: AgentCatalogue, control: str) -> None:
    add_agent(agents, control)
    trace = drive(catalogue, control)
    assert trace.step_count == 41


def test_values_and_lines_are_logged_where_they_were_said(
    agents: Path, catalogue: AgentCatalogue
) -> None:
    add_agent(agents, "drives")
    trace = drive(catalogue, "drives")
    assert trace.log_names == ("time", "seldom")
    assert np.allclose(trace.log_values[:-1, 0, 0], trace.times[:-1])
    seldom = trace.log_values[:-1, 0, 1]
    assert np.isnan(seldom[:FAULT_STEP]).all()
    assert (seldom[FAULT_STEP:] == 1.0).all()
    assert trace.log_events[0].message == "set up for ego"
    assert [(e.step, e.message) for e in trace.log_events[1:3]] == [(10, "acts"), (11, "acts")]


def test_planned_paths_arrive_ten_times_a_second(agents: Path, catalogue: AgentCatalogue) -> None:
    add_agent(agents, "plans")
    trace = drive(catalogue, "plans")
    assert [plan.step for plan in trace.plans] == list(range(FAULT_STEP, 40, 2))
    points = trace.ego_routes[0].line[[0, 5, 9]]
    for plan in trace.plans:
        np.testing.assert_allclose(plan.points, points, rtol=1e-6)


def test_a_process_stays_for_the_next_run(agents: Path, catalogue: AgentCatalogue) -> None:
    add_agent(agents, "drives")
    first = drive(catalogue, "drives")
    before = [process.pid for process in processes_with([str(agents)])]
    again = drive(catalogue, "drives")
    assert [process.pid for process in processes_with([str(agents)])] == before
    assert trace_sha256(again) == trace_sha256(first)
    catalogue.close()
    assert left_behind(agents) == []


def test_an_idle_process_that_was_killed_is_replaced(
    agents: Path, catalogue: AgentCatalogue
) -> None:
    add_agent(agents, "drives")
    drive(catalogue, "drives")
    for process in processes_with([str(agents)]):
        process.kill()
        process.wait(30)
    assert drive(catalogue, "drives").step_count == 41


def test_each_ego_has_a_process_of_its_own(agents: Path, perform: Perform) -> None:
    add_agent(agents, "drives")
    other = (place("-harbour_1_0", 20), place("-harbour_1_0", 120))
    two = scenario(
        ego(START, END, agent="drives", name="one"),
        ego(*other, agent="drives", name="two"),
        seconds=2.0,
    )
    assert perform(two).status is RunStatus.FINISHED
    guards = processes_with([str(agents), "guard.py"])
    assert len(guards) == 2


FAILING = {
    "dies": ("agent_died", "was ended by SIGSEGV", "about to be killed"),
    "exits": ("agent_died", "exited with code 3", "exited with code 3"),
    "raises": ("agent_raised", "KeyError: 'lost the way'", "Traceback"),
    "setup-raises": ("agent_raised", "no way in setup", "Traceback"),
    "answers-nothing": ("agent_raised", "NoneType", "Traceback"),
    "answers-nan": ("agent_invalid_control", "not finite", "ready to do"),
    "garbled-step": ("agent_invalid_control", "no StepReply", ""),
    "garbled-description": ("agent_protocol", "no Description", ""),
    "raises-in-chinese": ("agent_raised", "ValueError: 路路", "\\udcff"),
    "declares-twice": ("agent_invalid_control", "'speed' for its log twice", ""),
    "declares-too-much": ("agent_invalid_control", "declares 1001 values", ""),
    "offers-nothing": ("agent_protocol", "does not offer Describe", ""),
    "undeclared-value": ("agent_invalid_control", "'surprise'", ""),
    "half-a-point": ("agent_invalid_control", "a plan of 3 numbers", ""),
    "offers-no-step": ("agent_protocol", "does not offer RunStep", ""),
    "old-protocol": ("agent_protocol", "version 2", ""),
    "does-not-start": ("agent_died", "exited with code 1 before", "cannot find my weights"),
    "floods": ("agent_died", "exited with code 3", "last words"),
}


@pytest.fixture(scope="module")
def worker(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Perform]:
    """A worker that goes on through all failures, with an agent that drives among its agents."""
    agents = tmp_path_factory.mktemp("failing")
    for what in ("drives", *FAILING):
        add_agent(agents, what)
    catalogue = AgentCatalogue(folder=agents)
    setup = WorkerSetup(shipped_networks=shipped_networks(), agents=agents)

    def its_agents(setup: WorkerSetup) -> AgentCatalogue:
        return catalogue

    def perform_run(what: Scenario) -> RunReport:
        with pytest.MonkeyPatch.context() as patch:
            # The same object in every run, else it would count as a change by the agent.
            patch.setattr(performing, "agents_of", its_agents)
            spec = RunSpec(run_id="run", document=canonical_json(what))
            return performing.perform(spec, setup)

    yield perform_run
    catalogue.close()
    assert processes_with([str(agents)]) == []


def test_reports_tell_the_version_of_the_ads(agents: Path, perform: Perform) -> None:
    add_agent(agents, "drives", version="week 47")
    add_agent(agents, "raises", version="week 48")
    report = perform(one_ego("drives", seconds=0.5))
    assert report.versions["drives"] == "week 47"
    failed = perform(one_ego("raises"))
    assert failed.status is RunStatus.AGENT_FAILED
    assert failed.versions["raises"] == "week 48"
    assert failed.versions["libsumo"] == report.versions["libsumo"]


@pytest.mark.parametrize("what", FAILING)
def test_each_way_to_fail_is_told_apart_and_the_worker_goes_on(worker: Perform, what: str) -> None:
    cause, says, logs = FAILING[what]
    failure = failure_of(worker(one_ego(what)))
    assert failure.cause == cause
    assert says in failure.message
    assert f"'{what}'" in failure.message
    assert logs in failure.log
    assert len(failure.log) < 20_000
    assert worker(one_ego("drives")).status is RunStatus.FINISHED


def test_an_ads_that_was_killed_is_not_to_blame(agents: Path, perform: Perform) -> None:
    add_agent(agents, "is-killed")
    report = perform(one_ego("is-killed"))
    assert report.status is RunStatus.INFRASTRUCTURE_FAILED
    assert report.failure is not None
    assert report.failure.cause == "agent_killed"
    assert "was ended by SIGKILL" in report.failure.message
    assert "about to be killed" in report.failure.log
    assert left_behind(agents) == []


@pytest.mark.parametrize("what", ["hangs", "setup-hangs", "hangs-with-a-child"])
def test_an_ads_that_hangs_is_ended_with_what_it_started(
    agents: Path, perform: Perform, what: str
) -> None:
    add_agent(agents, what, step=0.7)
    failure = failure_of(perform(one_ego(what)))
    assert failure.cause == "agent_hung"
    assert "within 0.7 s" in failure.message
    assert "ready to do" in failure.log
    assert left_behind(agents) == []


def test_an_ads_that_never_answers_is_ended(agents: Path, perform: Perform) -> None:
    add_agent(agents, "never-answers", start=6.0)
    failure = failure_of(perform(one_ego("never-answers")))
    assert failure.cause == "agent_unreachable"
    assert "did not answer Describe within 6 s" in failure.message
    assert "dreaming" in failure.log
    assert left_behind(agents) == []


def test_a_process_that_cannot_be_started_is_told_of(agents: Path, perform: Perform) -> None:
    add_agent(agents, "drives", variables={"LONGER_THAN_THE_SYSTEM_TAKES": "x" * 200_000})
    failure = failure_of(perform(one_ego("drives")))
    assert failure.cause == "agent_died"
    assert "'drives' cannot be started: " in failure.message
    assert left_behind(agents) == []


def test_the_log_takes_no_more_text_than_it_has_room_for(
    agents: Path, catalogue: AgentCatalogue
) -> None:
    add_agent(agents, "talks-too-much")
    trace = drive(catalogue, "talks-too-much")
    assert trace.step_count == 41
    assert trace.log_events[-1].message == "[the log is full]"
    assert len(trace.log_events) < 300_000


def test_a_command_that_cannot_be_started_is_told_of(agents: Path, perform: Perform) -> None:
    add_agent(agents, "drives", command=["./no-such-program"])
    failure = failure_of(perform(one_ego("drives")))
    assert failure.cause == "agent_died"
    assert "no-such-program" in failure.log


def test_a_call_ends_before_the_slot_would_end_the_worker(agents: Path) -> None:
    add_agent(agents, "hangs", step=3000.0)
    setup = WorkerSetup(shipped_networks=shipped_networks(), agents=agents, agent_deadline_s=1.4)
    worker_catalogues.agents_of.cache_clear()
    document = canonical_json(one_ego("hangs"))
    report = performing.perform(RunSpec(run_id="run", document=document), setup)
    worker_catalogues.agents_of.cache_clear()
    assert failure_of(report).cause == "agent_hung"
    assert "within 0.7 s" in failure_of(report).message


def test_an_ads_at_an_address_is_reached_and_left_alone(
    agents: Path, catalogue: AgentCatalogue, tmp_path: Path
) -> None:
    add_agent(agents, "drives")
    home = AgentCatalogue(folder=agents)
    here = home.create("drives", {})
    assert here is not None
    socket = next((tmp_path / "temporary").resolve().glob("*/own/socket"))
    add_agent(agents, "elsewhere", command=[], address=f"unix:{socket}")
    trace = drive(catalogue, "elsewhere")
    assert trace.step_count == 41
    catalogue.close()
    assert len(processes_with([str(agents), "guard.py"])) == 1
    home.close()


def test_an_address_without_ads_is_reported(agents: Path, perform: Perform, tmp_path: Path) -> None:
    address = f"unix:{tmp_path / 'nobody'}"
    add_agent(agents, "elsewhere", command=[], address=address, start=0.5)
    failure = failure_of(perform(one_ego("elsewhere")))
    assert failure.cause == "agent_unreachable"
    assert address in failure.message


def test_two_runs_at_one_address_do_not_mix(
    agents: Path, catalogue: AgentCatalogue, perform: Perform, tmp_path: Path
) -> None:
    add_agent(agents, "drives")
    catalogue.create("drives", {})
    socket = next((tmp_path / "temporary").resolve().glob("*/own/socket"))
    add_agent(agents, "elsewhere", command=[], address=f"unix:{socket}")
    other = (place("-harbour_1_0", 20), place("-harbour_1_0", 120))
    two = scenario(
        ego(START, END, agent="elsewhere", name="one"),
        ego(*other, agent="elsewhere", name="two"),
        seconds=2.0,
    )
    failure = failure_of(perform(two))
    assert "another run has begun here" in failure.message
    catalogue.close()


def test_an_ads_does_not_see_the_settings_of_the_service(
    agents: Path, perform: Perform, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("DRIVORA_DATABASE_URL", "postgresql://user:secret@host/db")
    code = "import os; print(sorted(os.environ)); print(os.environ['GREETING'])"
    add_agent(
        agents, "drives", command=["{python}", "-c", code], variables={"GREETING": "good day"}
    )
    log = failure_of(perform(one_ego("drives"))).log
    assert "DRIVORA_AGENT_ADDRESS" in log
    assert "DRIVORA_DATABASE_URL" not in log
    assert "good day" in log


def test_the_folder_for_temporary_files_may_have_a_long_path(
    catalogue: AgentCatalogue, agents: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    add_agent(agents, "drives")
    folder = tmp_path / ("long" * 30)
    folder.mkdir()
    with monkeypatch.context() as patch:
        patch.setattr(tempfile, "tempdir", str(folder))
        assert drive(catalogue, "drives").step_count > 1


_WORKER = """
import sys, time
from pathlib import Path
from drivora_service.agents.catalogue import AgentCatalogue

catalogue = AgentCatalogue(folder=Path(sys.argv[1]))
agent = catalogue.create("hangs", {})
Path(sys.argv[2]).touch()
time.sleep(3600)
"""


def test_an_ads_dies_with_its_worker(agents: Path, tmp_path: Path) -> None:
    add_agent(agents, "hangs")
    ready = tmp_path / "ready"
    worker = subprocess.Popen(
        [sys.executable, "-c", _WORKER, str(agents), str(ready)],
        env={**os.environ, "TMPDIR": str((tmp_path / "temporary").resolve())},
    )
    try:
        wait_until(ready.exists)
        # The guard and the ADS; the worker has the folder in its command line as well.
        assert len(processes_with([str(agents)])) == 3
    finally:
        worker.kill()
        worker.wait()
    wait_until(lambda: left_behind(agents) == [])
