"""Workers that really cannot start: the simulator's library cannot be loaded, the code is missing,
or the process dies."""

from __future__ import annotations

import contextlib
import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from drivora_service.cli.campaigns.campaign_files import read_campaign_file, shipped_campaigns
from drivora_service.errors import WorkersCannotStart
from drivora_service.execution.dispatcher import Dispatcher
from drivora_service.execution.infrastructure import Infrastructure
from drivora_service.execution.local import LocalExecutor
from drivora_service.execution.spec_running import run_all
from drivora_service.execution.worker_starts import WorkerStarts, pause_s
from drivora_service.runs.run_report import RunSpec, RunStatus
from drivora_service.store.database import Database, open_database
from drivora_service.store.runs.run_records import NewRun, Priority
from drivora_service.store.traces.trace_folders import TraceFolder
from tests.command_process import begin
from tests.execution.owners import server

TASKS = "tests.execution.worker_tasks:perform"
WARM_UP = "tests.execution.worker_tasks:start_if_there"


@contextlib.contextmanager
def workers(tmp_path: Path, *, slots: int = 1, warm_up: str = WARM_UP) -> Iterator[LocalExecutor]:
    """Workers that start only where the file ``can-start`` is."""
    with LocalExecutor(
        slots=slots,
        setup=tmp_path / "can-start",
        folder=tmp_path / "workers",
        perform=TASKS,
        warm_up=warm_up,
    ) as executor:
        yield executor


def wait_for_fault(executor: LocalExecutor) -> str:
    limit = time.monotonic() + 60
    while not executor.fault:
        assert time.monotonic() < limit
        time.sleep(0.02)
    return executor.fault


def specs(count: int) -> list[RunSpec]:
    return [RunSpec(run_id=f"run-{number}", document="sleep 0") for number in range(count)]


def test_runs_stop_at_once_with_the_reason(tmp_path: Path) -> None:
    with workers(tmp_path, slots=2) as executor, pytest.raises(WorkersCannotStart) as stopped:
        list(run_all(executor, specs(20)))
    assert "OSError: a worker needs can-start" in str(stopped.value)


def test_what_cannot_be_imported_is_named(tmp_path: Path) -> None:
    with workers(tmp_path, warm_up="nowhere.at.all:warm_up") as executor:
        assert "nowhere" in wait_for_fault(executor)
        assert "nowhere" in executor.slots()[0].last_crash
    assert "Traceback" in (tmp_path / "workers" / "slot-0.log").read_text()


def test_a_start_that_is_lost_once_is_no_fault(tmp_path: Path) -> None:
    with workers(tmp_path, warm_up="tests.execution.worker_tasks:die_once") as executor:
        (report,) = run_all(executor, specs(1))
        assert report.status is RunStatus.FINISHED
        assert executor.slots()[0].restarts == 1
        assert "SIGKILL" not in executor.fault


def test_starts_that_are_lost_again_and_again_are_a_fault(tmp_path: Path) -> None:
    with (
        workers(tmp_path, warm_up="tests.execution.worker_tasks:die") as executor,
        pytest.raises(WorkersCannotStart, match="before it was ready"),
    ):
        list(run_all(executor, specs(1)))


def test_closing_does_not_wait_for_the_next_try(tmp_path: Path) -> None:
    with workers(tmp_path) as executor:
        wait_for_fault(executor)
        time.sleep(1.5)
        begun = time.monotonic()
    assert time.monotonic() - begun < 1.0


def test_one_slot_that_can_start_is_enough() -> None:
    told: list[None] = []
    starts = WorkerStarts(on_fault=lambda: told.append(None))
    starts.add("a")
    starts.add("b")
    starts.note_failure("a", "no library", certain=True)
    starts.note_success("b")
    assert (starts.fault, told) == ("", [])
    starts.note_failure("b", "no library", certain=True)
    assert (starts.fault, told) == ("no library", [None])
    starts.note_failure("b", "no library", certain=True)
    assert told == [None]
    starts.note_success("a")
    assert starts.fault == ""


def test_tries_become_rarer_up_to_a_limit() -> None:
    assert [pause_s(failures) for failures in (1, 2, 3, 4, 5, 6, 5000)] == [1, 2, 4, 8, 16, 30, 30]


@pytest.fixture
def database(tmp_path: Path) -> Iterator[Database]:
    opened = open_database(f"sqlite:///{tmp_path / 'drivora.sqlite3'}")
    yield opened
    opened.close()


def test_runs_stay_queued_and_lose_no_attempt(
    database: Database, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    with database.write() as transaction:
        batch = transaction.batches.create(name="batch", priority=Priority.CI)
        new = NewRun(
            document="sleep 0", scenario_sha256="s", town="town", agent="idm", label="label"
        )
        ids = transaction.jobs.submit([new] * 5, batch_id=batch.id)

    def statuses() -> set[RunStatus]:
        with database.read() as transaction:
            return {job.status for job in transaction.jobs.page(limit=10).items}

    with workers(tmp_path, slots=2) as executor:
        dispatcher = Dispatcher(
            database,
            executor,
            TraceFolder(tmp_path),
            Infrastructure({}),
            server(database, tmp_path),
        )
        dispatcher.start()
        try:
            wait_for_fault(executor)
            time.sleep(3.5)
            assert statuses() == {RunStatus.QUEUED}
            assert "a worker needs can-start" in dispatcher.fault
            (tmp_path / "can-start").touch()
            limit = time.monotonic() + 60
            while statuses() != {RunStatus.FINISHED} and time.monotonic() < limit:
                time.sleep(0.05)
            assert statuses() == {RunStatus.FINISHED}
            assert dispatcher.fault == ""
        finally:
            dispatcher.stop()
    with database.read() as transaction:
        outcomes = {a.outcome for run_id in ids for a in transaction.jobs.attempts(run_id)}
    assert outcomes <= {"released", "finished"}
    log = "".join(capfd.readouterr())
    assert [log.count(event) for event in ("workers_cannot_start", "workers_start_again")] == [1, 1]


# Below, the real libsumo, of which the loader finds a library that it cannot use.


@pytest.fixture
def environment(tmp_path: Path) -> dict[str, str]:
    broken = tmp_path / "broken"
    broken.mkdir()
    (broken / "libX11.so.6").touch()
    return {
        **os.environ,
        "LD_LIBRARY_PATH": str(broken),
        "DRIVORA_DATA_DIR": str(tmp_path / "data"),
    }


def drivora(
    environment: dict[str, str], *arguments: str | Path
) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "drivora_service.cli", *map(str, arguments)],
        env=environment,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )


def assert_says_what_is_missing(text: str) -> None:
    assert "libsumo cannot be loaded" in text
    assert "Missing on this system: libX11.so.6" in text
    assert "Traceback" not in text


EXAMPLE = "openscenario_schemas/examples/walker-behind-van.json"


def test_a_run_without_the_simulator_stops(environment: dict[str, str], repository: Path) -> None:
    ended = drivora(environment, "run", repository / EXAMPLE, "--json")
    assert (ended.returncode, ended.stdout) == (3, "")
    assert_says_what_is_missing(ended.stderr)


@pytest.mark.slow(seconds=15)
def test_a_campaign_without_the_simulator_stops_and_can_be_resumed(
    environment: dict[str, str], tmp_path: Path
) -> None:
    file = tmp_path / "campaign.json"
    content = read_campaign_file(shipped_campaigns() / "side-collision.yaml")
    file.write_text(json.dumps({**content, "budget": {"simulations": 3}}))
    ended = drivora(environment, "campaign", "run", file)
    assert ended.returncode == 3, ended.stderr
    assert_says_what_is_missing(ended.stderr)
    # From here on with a loader that finds the library, as the fork server of the tests has it.
    listed = json.loads(forked_drivora(environment, tmp_path, "list", "--json"))
    assert [(one["state"], one["counts"]["evaluations"]) for one in listed] == [("paused", 0)]
    forked_drivora(environment, tmp_path, "resume", listed[0]["id"])


def forked_drivora(environment: dict[str, str], folder: Path, *arguments: str) -> str:
    """Runs ``drivora campaign``, which must end well; returns what it printed."""
    out, err = folder / f"{arguments[0]}.out", folder / f"{arguments[0]}.err"
    begun = begin("campaign", *arguments, folder=folder, environment=environment, out=out, err=err)
    assert begun.wait(120.0) == 0, err.read_text()
    return out.read_text()


def test_the_demo_without_the_simulator_stops(environment: dict[str, str], tmp_path: Path) -> None:
    ended = drivora(environment, "demo", "--data-dir", tmp_path / "demo", "--num", "2")
    assert ended.returncode == 3, ended.stderr
    assert_says_what_is_missing(ended.stderr)
    log = (tmp_path / "demo" / "service.log").read_text()
    assert log.count("workers_cannot_start") == 1
    assert_says_what_is_missing(log)


def test_a_folder_of_temporary_files_that_holds_no_socket_is_named(
    tmp_path: Path, repository: Path
) -> None:
    # Folders of pytest grow long by themselves; of this one, 75 characters would be accepted.
    folder = tmp_path / ("t" * max(1, 76 - len(str(tmp_path)) - 1))
    folder.mkdir()
    environment = os.environ | {"TMPDIR": str(folder), "DRIVORA_DATA_DIR": str(tmp_path / "data")}
    example = repository / "openscenario_schemas" / "examples" / "walker-behind-van.json"
    refused = drivora(environment, "run", example)
    assert refused.returncode == 2
    assert "AF_UNIX path too long" in refused.stderr
    assert f"no worker process can be started from the folder of temporary files, {folder}" in (
        refused.stderr
    )
    assert "a path of at most 75 characters" in refused.stderr
