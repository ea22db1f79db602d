"""Runs, campaigns and a service on a real Ray cluster whose nodes come and go."""

from __future__ import annotations

import contextlib
import copy
import json
import threading
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import httpx
import psutil
import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.document.campaign_reading import read_campaign
from drivora_service.campaigns.evaluation.local_evaluator import LocalEvaluator
from drivora_service.campaigns.records.journal import MemoryJournal
from drivora_service.campaigns.search.conducting import conduct
from drivora_service.campaigns.search.search_preparation import prepare_search
from drivora_service.errors import WorkersCannotStart
from drivora_service.execution.executor import Executor
from drivora_service.execution.local import LocalExecutor
from drivora_service.execution.ray import ray_connection
from drivora_service.execution.ray.ray_executor import RayExecutor
from drivora_service.execution.spec_running import run_all
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.runs.run_report import RunReport, RunSpec, RunStatus
from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.seed_generation import generate_seeds
from drivora_service.scenario.validation import validate_document
from drivora_service.store.campaigns.campaign_records import EvaluationRecord
from drivora_service.worker.setup import WorkerSetup
from tests.campaigns.analytic import sequence
from tests.execution.attempts import LIMITS, TASKS, failure_of, pid_of, run, wait_for
from tests.execution.ray_cluster import SILENCE_S, Cluster, ray_cluster, until
from tests.forked_service import forked_service

pytestmark = pytest.mark.slow(seconds=10)

SIMULATIONS = 40
SETUP = WorkerSetup(shipped_networks=shipped_networks())


@contextlib.contextmanager
def of_tasks(address: str, folder: Path) -> Iterator[RayExecutor]:
    with RayExecutor(
        address=address, setup="", folder=folder, limits=LIMITS, perform=TASKS, warm_up=""
    ) as executor:
        yield executor


class PausingJournal(MemoryJournal):
    """A journal whose campaign waits before some evaluations until something has happened."""

    def __init__(self, pauses: Mapping[int, threading.Event]) -> None:
        super().__init__()
        self._pauses = pauses

    def append(self, record: EvaluationRecord, document: str) -> None:
        if record.number in self._pauses:
            until(self._pauses[record.number].is_set)
        super().append(record, document)


def test_traces_are_those_of_one_machine(ray_nodes: Cluster, tmp_path: Path) -> None:
    networks = NetworkCatalogue(shipped_networks())
    seeds = generate_seeds(
        networks.get("tee-town"), count=6, min_length=50, max_length=120, seed=3, agent="idm"
    )
    documents = [canonical_json(validate_document(s, networks, ("idm",)).scenario) for s in seeds]

    def hashes(executor: Executor, folder: Path) -> dict[str, str]:
        folder.mkdir()
        specs = [
            RunSpec(run_id=str(n), document=text, trace_path=str(folder / f"{n}.parquet"))
            for n, text in enumerate(documents)
        ]
        reports: list[RunReport] = list(run_all(executor, specs))
        assert {report.status for report in reports} == {RunStatus.FINISHED}
        assert all((folder / f"{n}.parquet").stat().st_size for n in range(len(documents)))
        return {report.run_id: report.trace_sha256 for report in reports}

    with LocalExecutor(slots=1, setup=SETUP, folder=tmp_path) as local:
        here = hashes(local, tmp_path / "local")
    with RayExecutor(
        address=ray_nodes.address, setup=SETUP, folder=tmp_path, node_folder=tmp_path / "nodes"
    ) as ray:
        there = hashes(ray, tmp_path / "ray")
    assert here == there
    assert len(set(here.values())) == len(documents)
    # Each node keeps the logs of its workers in the shared folder.
    assert len(list((tmp_path / "nodes").glob("*/slot-0.log"))) == 2


def test_a_campaign_is_the_same_while_nodes_die_and_join(
    ray_nodes: Cluster, tmp_path: Path
) -> None:
    document: dict[str, Any] = {
        "name": "tee",
        "tester": {"name": "avfuzzer"},
        "agent": {"name": "idm"},
        "scenario": copy.deepcopy(SCENARIO),
        "space": {"vehicles": 2, "walkers": 2},
        "oracles": ["collision", "discomfort"],
        "budget": {"simulations": SIMULATIONS},
        "seed": 3,
    }
    catalogues = Catalogues(NetworkCatalogue(shipped_networks()))

    def evaluations(executor: Executor, journal: MemoryJournal) -> list[EvaluationRecord]:
        search = prepare_search(read_campaign(document, catalogues), catalogues, run_prefix="x")
        with contextlib.closing(LocalEvaluator(executor)) as evaluator:
            conduct(search, evaluator, journal, confirm=False)
        return list(journal.evaluations())

    undisturbed = evaluations(
        LocalExecutor(slots=2, setup=SETUP, folder=tmp_path / "local"), MemoryJournal()
    )
    # A search on one slot may otherwise be over before another node has joined and worked.
    joined, worked = threading.Event(), threading.Event()
    journal = PausingJournal({SIMULATIONS // 2: joined, SIMULATIONS - 1: worked})
    executor = RayExecutor(address=ray_nodes.address, setup=SETUP, folder=tmp_path / "ray")
    seen: list[set[str]] = []

    def disturb() -> None:
        until(lambda: len(executor.slots()) == 2 and len(list(journal.evaluations())) >= 5)
        seen.append({slot.name for slot in executor.slots()})
        ray_nodes.kill(ray_nodes.nodes[0])
        until(lambda: len(executor.slots()) == 1)
        seen.append({slot.name for slot in executor.slots()})
        ray_nodes.add(1)
        until(lambda: len(executor.slots()) == 2)
        seen.append({slot.name for slot in executor.slots()})
        joined.set()
        until(lambda: all(slot.runs for slot in executor.slots()))
        worked.set()

    disturbing = threading.Thread(target=disturb)
    disturbing.start()
    disturbed = evaluations(executor, journal)
    disturbing.join()
    assert [len(names) for names in seen] == [2, 1, 2]
    assert seen[0] != seen[2]
    assert len(disturbed) == len(undisturbed) >= SIMULATIONS
    assert sequence(disturbed) == sequence(undisturbed)


def test_a_lost_node_costs_its_runs_one_attempt(ray_nodes: Cluster, tmp_path: Path) -> None:
    with of_tasks(ray_nodes.address, tmp_path) as executor:
        until(lambda: len(executor.slots()) == 2)
        for run_id in ("one", "two"):
            executor.submit(RunSpec(run_id=run_id, document="hangs"))
        pids = [pid_of(executor, run_id) for run_id in ("one", "two")]
        ray_nodes.kill(ray_nodes.nodes[0])
        (end,) = wait_for(executor, 1)
        assert end.report.status is RunStatus.INFRASTRUCTURE_FAILED
        assert failure_of(end.report).cause == "worker_lost"
        assert end.worker not in {slot.name for slot in executor.slots()}
        assert (executor.capacity, executor.fault) == (1, "")
        executor.cancel("one")
        executor.cancel("two")
        assert [end.report.status for end in wait_for(executor, 1)] == [RunStatus.CANCELLED]
        # The worker of the lost node has ended with it.
        until(lambda: not any(map(psutil.pid_exists, pids)))
        assert run(executor, "sleep 0").report.status is RunStatus.FINISHED
    ray_nodes.add(1)


def test_without_a_node_runs_wait_and_a_cluster_that_ends_is_a_fault(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ray_connection, "_SILENCE_S", SILENCE_S)
    with ray_cluster() as cluster, of_tasks(cluster.address, tmp_path) as executor:
        executor.submit(RunSpec(run_id="run", document="sleep 0"))
        until(lambda: executor.fault)
        assert "no node of the Ray cluster" in executor.fault
        assert executor.slots() == ()
        cluster.add(1)
        assert [end.report.status for end in wait_for(executor, 1)] == [RunStatus.FINISHED]
        assert executor.fault == ""

        executor.submit(RunSpec(run_id="running", document="hangs"))
        pid_of(executor, "running")
        executor.submit(RunSpec(run_id="waiting", document="hangs"))
        cluster.end()
        until(lambda: executor.fault)
        assert f"the Ray cluster at {cluster.address}" in executor.fault
        causes = {end.report.run_id: failure_of(end.report).cause for end in wait_for(executor, 2)}
        assert causes == {"running": "worker_lost", "waiting": "not_begun"}
        assert executor.withdraw() == ()
        assert executor.slots() == ()
        with pytest.raises(WorkersCannotStart, match="the Ray cluster at"):
            list(run_all(executor, [RunSpec(run_id="run", document="sleep 0")]))


@pytest.mark.parametrize(
    ("address", "message"),
    [
        ("127.0.0.1:9", "the Ray cluster at 127.0.0.1:9 cannot be reached: .*refused"),
        ("ray://127.0.0.1:10001", "write HOST:PORT, or auto"),
    ],
)
def test_an_address_without_a_cluster_is_a_fault(
    address: str, message: str, tmp_path: Path
) -> None:
    with of_tasks(address, tmp_path) as executor, pytest.raises(WorkersCannotStart, match=message):
        list(run_all(executor, [RunSpec(run_id="run", document="sleep 0")]))


def test_a_service_runs_a_batch_on_the_nodes(ray_nodes: Cluster, tmp_path: Path) -> None:
    options = ("--executor", "ray", "--ray-address", ray_nodes.address)
    with (
        forked_service(tmp_path / "data", *options, workers=1) as url,
        httpx.Client(base_url=f"{url}/api/v1", timeout=60.0) as client,
    ):
        scenarios = [json.dumps({**SCENARIO, "seed": number}) for number in range(6)]
        answer = client.post(
            "/batches",
            content="\n".join(scenarios),
            headers={"Content-Type": "application/x-ndjson"},
        )
        batch = answer.raise_for_status().headers["Location"].rsplit("/", 1)[-1]
        until(lambda: client.get(f"/batches/{batch}").raise_for_status().json()["done"])
        runs = client.get("/runs", params={"batch": batch}).raise_for_status().json()["items"]
        assert [one["status"] for one in runs] == ["finished"] * 6
        observations = client.get(f"/runs/{runs[0]['id']}/observations")
        assert observations.raise_for_status().text.count("\n") > 10
        slots = client.get("/workers").json()["slots"]
        assert len({slot["name"].rpartition("/")[0] for slot in slots}) == 2
        pids = [slot["pid"] for slot in slots]
        assert all(map(psutil.pid_exists, pids))
    until(lambda: not any(map(psutil.pid_exists, pids)))
