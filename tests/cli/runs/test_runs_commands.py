"""``drivora runs``, and what the runs of commands are while others work on the same data folder."""

from __future__ import annotations

import json
import os
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time
from contextlib import closing
from pathlib import Path

import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.runs.run_report import RunStatus
from drivora_service.store.database import open_database
from tests.cli.conftest import Drivora
from tests.command_process import Begun, begin
from tests.forked_service import forked_service

LONG = 40
"""Scenarios of a command that is to be killed in between."""


def begin_run(tmp_path: Path, folder: Path, **environment: str) -> Begun:
    """Starts ``drivora run`` on one worker and does not wait for it."""
    log = tmp_path / "run.log"
    variables = {**os.environ, "DRIVORA_DATA_DIR": str(tmp_path / "data"), **environment}
    arguments = ("run", folder, "--workers", "1")
    return begin(*arguments, folder=tmp_path, environment=variables, out=log, err=log)


def start_run(tmp_path: Path, folder: Path, **environment: str) -> subprocess.Popen[bytes]:
    """Does the same as a shell would, with a fork server of its own."""
    command = [sys.executable, "-m", "drivora_service.cli", "run", str(folder), "--workers", "1"]
    with (tmp_path / "run.log").open("ab") as log:
        return subprocess.Popen(
            command,
            stdout=log,
            stderr=log,
            cwd=tmp_path,
            env={**os.environ, "DRIVORA_DATA_DIR": str(tmp_path / "data"), **environment},
        )


def wait_for_status(
    tmp_path: Path, process: subprocess.Popen[bytes] | Begun, status: RunStatus
) -> None:
    """Waits until a run of the data folder has a status."""
    path = tmp_path / "data" / "drivora.sqlite3"
    deadline = time.monotonic() + 120.0
    while not path.exists():
        assert time.monotonic() < deadline
        time.sleep(0.05)
    database = open_database(f"sqlite:///{path}")
    try:
        while True:
            with database.read() as transaction:
                if any(
                    batch.counts.get(status) for batch in transaction.batches.page(limit=1).items
                ):
                    return
            assert time.monotonic() < deadline
            assert process.poll() is None, (tmp_path / "run.log").read_text()
            time.sleep(0.02)
    finally:
        database.close()


@pytest.fixture
def many(tmp_path: Path) -> Path:
    """A folder of many scenarios."""
    folder = tmp_path / "many"
    folder.mkdir()
    for number in range(LONG):
        (folder / f"{number:02d}.json").write_text(json.dumps(SCENARIO))
    return folder


def test_a_run_of_a_command_is_a_stored_run(
    drivora: Drivora, scenario_file: Path, tmp_path: Path
) -> None:
    ran = drivora("run", scenario_file, "--agent", "sumo-idm", "--json").json()
    (listed,) = drivora("runs", "list", "--json").json()
    shown = drivora("runs", "show", ran["id"], "--json").json()
    assert listed["id"] == shown["id"] == ran["id"]
    assert shown.items() <= ran.items()
    assert listed["trace_sha256"] == ran["trace_sha256"] != ""
    assert drivora("runs", "list", "--agent", "idm", "--json").json() == []
    assert ran["id"] in drivora("runs", "list", "--status", "finished").out
    again = tmp_path / "again.json"
    assert drivora("runs", "scenario", ran["id"], "--out", again).code == 0
    repeated = drivora("run", again, "--json").json()
    assert repeated["agent"] == "sumo-idm"
    assert repeated["trace_sha256"] == ran["trace_sha256"]
    picture = tmp_path / "run.svg"
    assert drivora("plot", ran["id"], "--out", picture).code == 0
    assert picture.read_text().lstrip().startswith("<?xml")


def test_what_cannot_be_shown(drivora: Drivora) -> None:
    drivora("store", "migrate")
    unknown = drivora("runs", "show", "no-such-run")
    assert (unknown.code, unknown.out) == (2, "")
    assert "unknown run 'no-such-run'. There is no run yet: run scenarios with" in unknown.err
    missing = drivora("plot", "r1/missing.parquet")
    assert (missing.code, missing.err.strip()) == (2, "no such file: r1/missing.parquet")
    nothing = drivora("plot", "r1/x.report.json")
    assert nothing.code == 2
    assert "r1/x.report.json: neither a trace file (.parquet) nor" in nothing.err
    assert drivora("runs", "list", "--oracle", "collision", "--json").json() == []
    nameless = drivora("runs", "list", "--oracle", "nope")
    assert nameless.code == 2
    assert "unknown oracle 'nope'; known: " in nameless.err
    wrong = drivora("runs", "list", "--status", "done")
    assert wrong.code == 2
    assert "known: queued" in wrong.err


def test_options_for_one_place_are_refused_at_the_other(
    drivora: Drivora, scenario_file: Path
) -> None:
    nowhere = "http://127.0.0.1:9"
    refused = drivora("run", scenario_file, "--server", nowhere, "--workers", "2")
    assert refused.code == 2
    assert "--workers" in refused.err


def test_a_command_that_can_store_nothing_ends_with_the_reason(
    drivora: Drivora, scenario_file: Path, tmp_path: Path
) -> None:
    traces = tmp_path / "data" / "traces"
    traces.parent.mkdir()
    traces.write_text("in the way")
    ended = drivora("run", scenario_file, "--workers", "1")
    assert ended.code == 3
    assert f"cannot begin runs: traces: nothing can be written to {traces}" in ended.err
    (run,) = drivora("runs", "list", "--json").json()
    assert run["status"] == "cancelled"
    assert f"drivora runs list --batch {run['batch_id']}" in ended.err


@pytest.mark.slow
def test_a_command_works_beside_a_service_on_the_same_data_folder(
    drivora: Drivora, scenario_file: Path, tmp_path: Path
) -> None:
    with forked_service(tmp_path / "data", workers=1) as url:
        here = drivora("run", scenario_file, "--json")
        assert here.code == 0, here.err
        there = drivora("run", scenario_file, "--server", url, "--json").json()
        assert there["trace_sha256"] == here.json()["trace_sha256"]
        assert (
            drivora("runs", "show", here.json()["id"], "--server", url, "--json").json()["status"]
            == "finished"
        )
    with closing(sqlite3.connect(tmp_path / "data" / "drivora.sqlite3")) as database:
        owners = [owner for (owner,) in database.execute("SELECT owner_id FROM batches")]
    # The first was for the process of the command alone, the other for any server.
    assert [bool(owner) for owner in owners] == [True, False]


@pytest.mark.slow
def test_runs_of_a_killed_command_are_cancelled_by_the_next(
    drivora: Drivora, many: Path, tmp_path: Path
) -> None:
    process = begin_run(tmp_path, many)
    wait_for_status(tmp_path, process, RunStatus.FINISHED)
    process.kill()
    process.wait()
    statuses = [run["status"] for run in drivora("runs", "list", "--json").json()]
    assert len(statuses) == LONG
    assert set(statuses) == {"finished", "cancelled"}
    assert [*(tmp_path / "data" / "commands").iterdir()] == []


@pytest.mark.slow
def test_a_service_leaves_the_runs_of_a_living_command_alone(
    drivora: Drivora, many: Path, tmp_path: Path
) -> None:
    process = begin_run(tmp_path, many)
    wait_for_status(tmp_path, process, RunStatus.RUNNING)
    with forked_service(tmp_path / "data", workers=2):
        assert process.wait(120.0) == 0, (tmp_path / "run.log").read_text()
        statuses = [run["status"] for run in drivora("runs", "list", "--json").json()]
    assert statuses == ["finished"] * LONG


@pytest.mark.slow
@pytest.mark.parametrize("request_to_end", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupted_run_cancels_what_has_not_ended(
    drivora: Drivora, many: Path, tmp_path: Path, request_to_end: signal.Signals
) -> None:
    # The folder of the test has too long a name for the sockets in it.
    with tempfile.TemporaryDirectory() as scratch:
        process: subprocess.Popen[bytes] | Begun
        if request_to_end == signal.SIGTERM:
            process = start_run(tmp_path, many, TMPDIR=scratch)
        else:
            process = begin_run(tmp_path, many, TMPDIR=scratch)
        wait_for_status(tmp_path, process, RunStatus.FINISHED)
        assert list(Path(scratch).glob("drivora-*"))
        process.send_signal(request_to_end)
        assert process.wait(60.0) == 130
        assert list(Path(scratch).glob("drivora-*")) == []
    log = (tmp_path / "run.log").read_text()
    assert "Traceback" not in log
    batch = drivora("runs", "list", "--json").json()[0]["batch_id"]
    assert f"its runs: drivora runs list --batch {batch}" in log
    statuses = [run["status"] for run in drivora("runs", "list", "--json").json()]
    assert set(statuses) == {"finished", "cancelled"}
    assert len(statuses) == LONG
