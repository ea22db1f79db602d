"""ADSs in processes of their own on the slots: the same everywhere, and nothing left behind."""

from __future__ import annotations

import json
import multiprocessing.util
import shutil
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import psutil
import pytest

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.execution.executor import Limits
from drivora_service.execution.local import LocalExecutor
from drivora_service.execution.spec_running import run_all
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.runs.run_report import RunReport, RunSpec, RunStatus
from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.model import BackgroundTraffic, Scenario
from drivora_service.scenario.validation import validate_data
from drivora_service.worker import performing, worker_catalogues
from drivora_service.worker.setup import WorkerSetup
from tests.agents.remote.folders import add_agent, processes_with, wait_until
from tests.simulation.episodes import ego, place, scenario

_ROOT = Path(__file__).resolve().parents[3]
EXAMPLE = _ROOT / "deploy" / "external-agent"
THREE_DRIVERS = _ROOT / "openscenario_schemas" / "examples" / "three-drivers.json"


@pytest.fixture
def agents(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder of agents; what their processes leave behind would be in ``temporary`` beside it."""
    # Made by Python once a process, and not to be in a folder that goes away with the test.
    multiprocessing.util.get_temp_dir()
    # Not in the test's own folder, whose path may be too long for a socket.
    with tempfile.TemporaryDirectory() as temporary:
        (tmp_path / "temporary").symlink_to(temporary)
        with monkeypatch.context() as patch:
            patch.setenv("TMPDIR", temporary)
            patch.setattr(tempfile, "tempdir", None)
            yield tmp_path / "agents"


def executor(agents: Path, slots: int) -> LocalExecutor:
    setup = WorkerSetup(shipped_networks=shipped_networks(), agents=agents, agent_deadline_s=60.0)
    return LocalExecutor(
        slots=slots,
        setup=setup,
        folder=agents.parent / "workers",
        limits=Limits(agent_deadline_s=60.0),
    )


def specs_of(scenarios: Iterator[Scenario]) -> list[RunSpec]:
    return [
        RunSpec(run_id=f"run-{number}", document=canonical_json(what))
        for number, what in enumerate(scenarios)
    ]


def one_ego(agent: str, seconds: float = 2.0) -> Scenario:
    route = (place("harbour_1_0", 20), place("harbour_1_0", 120))
    return scenario(ego(*route, agent=agent), seconds=seconds)


def left_behind(agents: Path) -> list[str]:
    folders = (agents.parent / "temporary").glob("drivora-agent-*")
    processes = processes_with([str(agents)])
    return [path.name for path in folders] + [process.info["name"] for process in processes]


@pytest.mark.slow
def test_the_example_drives_the_same_twice_and_on_two_workers(agents: Path) -> None:
    shutil.copytree(EXAMPLE, agents / EXAMPLE.name)
    route = (place("harbour_0_0", 120.0), place("harbour_1_0", 60.0))
    drives = [
        replace(
            scenario(ego(*route, agent=EXAMPLE.name), seconds=40.0, seed=seed),
            background_traffic=BackgroundTraffic(count=10),
        )
        for seed in (1, 2)
    ]
    specs = specs_of(iter(drives))
    hashes: list[dict[str, str]] = []
    for slots in (1, 2):
        with executor(agents, slots) as workers:
            reports = list(run_all(workers, specs))
            reports += run_all(
                workers, [replace(spec, run_id=f"{spec.run_id}-2") for spec in specs]
            )
        assert {report.status for report in reports} == {RunStatus.FINISHED}
        hashes.append({report.run_id: report.trace_sha256 for report in reports})
    assert hashes[0] == hashes[1]
    assert all(hashes[0][spec.run_id] == hashes[0][f"{spec.run_id}-2"] for spec in specs)
    assert len(set(hashes[0].values())) == len(specs)
    # The last ones end by themselves once their worker is gone.
    wait_until(lambda: left_behind(agents) == [])


@pytest.mark.slow(seconds=20)
def test_many_failing_runs_leave_nothing_behind(agents: Path) -> None:
    causes = {
        "dies": "agent_died",
        "hangs": "agent_hung",
        "garbled-step": "agent_invalid_control",
        "does-not-start": "agent_died",
        "raises": "agent_raised",
    }
    for what in causes:
        add_agent(agents, what, step=1.0 if what == "hangs" else 20.0)
    add_agent(agents, "drives")
    # A good run after every five bad ones, on slots that take turns.
    order = [what for _ in range(4) for what in (*causes, "drives")]
    specs = specs_of(one_ego(what) for what in order)
    open_before = psutil.Process().num_fds()
    # The service that other tests share, if one of them came before.
    before = psutil.Process().children(recursive=True)
    with executor(agents, 2) as workers:
        reports: dict[str, RunReport] = {r.run_id: r for r in run_all(workers, specs)}
        slots = workers.slots()
    assert len(reports) == 24
    for spec, what in zip(specs, order, strict=True):
        report = reports[spec.run_id]
        if what == "drives":
            assert report.status is RunStatus.FINISHED
        else:
            assert report.status is RunStatus.AGENT_FAILED
            assert report.failure is not None
            assert report.failure.cause == causes[what]
    assert len({r.trace_sha256 for r in reports.values() if r.trace_sha256}) == 1
    # No worker had to be replaced for any of it.
    assert [slot.restarts for slot in slots] == [0, 0]
    # The last ones end by themselves once their worker is gone.
    wait_until(lambda: left_behind(agents) == [])
    left = [p for p in psutil.Process().children(recursive=True) if p not in before]
    # Python's own, which stay as long as this process does.
    own = ("multiprocessing.resource_tracker", "multiprocessing.forkserver")
    assert [p for p in left if not any(name in " ".join(p.cmdline()) for name in own)] == []
    assert psutil.Process().num_fds() <= open_before + 4


@pytest.mark.slow
def test_three_egos_with_three_adss_drive_the_same_wherever_they_run(agents: Path) -> None:
    shutil.copytree(EXAMPLE, agents / EXAMPLE.name)
    content = json.loads(THREE_DRIVERS.read_text())
    assert len({ego["agent"]["name"] for ego in content["ego_vehicles"]}) == 3
    # One of the three in a process of its own.
    content["ego_vehicles"][2]["agent"] = {"name": EXAMPLE.name}
    content["max_sim_time"] = 8.0
    networks = NetworkCatalogue(shipped_networks())
    directory = AgentCatalogue(folder=agents).availability()
    valid = validate_data(content, networks, directory)
    spec = RunSpec(run_id="here", document=canonical_json(valid.scenario))
    setup = WorkerSetup(shipped_networks=shipped_networks(), agents=agents, agent_deadline_s=60.0)
    worker_catalogues.agents_of.cache_clear()
    try:
        reports = [performing.perform(spec, setup) for _ in range(2)]
    finally:
        worker_catalogues.agents_of(setup).close()
        worker_catalogues.agents_of.cache_clear()
    with executor(agents, 1) as workers:
        reports += run_all(workers, [replace(spec, run_id="worker")])
    assert [report.status for report in reports] == [RunStatus.FINISHED] * 3
    assert len({report.trace_sha256 for report in reports}) == 1
    assert set(reports[0].agent_cost_us) == {"ego_0", "ego_1", "ego_2"}
    wait_until(lambda: left_behind(agents) == [])
