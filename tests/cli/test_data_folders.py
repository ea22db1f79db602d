"""The data folder of commands: which of them make one, and what they say where there is none."""

from __future__ import annotations

import json
import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.cli.exit_codes import ExitCode
from drivora_service.store.locks.server_lock import ServerLock
from tests.cli.conftest import Drivora

REVISION = Path(__file__).parents[1] / "store" / "data" / "revision_0008.sql"
NO_SERVICE = "http://127.0.0.1:9"


@pytest.mark.parametrize(
    "arguments",
    [
        "runs list",
        "runs show r1",
        "plot r1",
        "campaign list",
        "campaign resume c1 --workers 1",
        "store verify",
    ],
)
def test_a_command_that_reads_makes_no_data_folder(
    drivora: Drivora, tmp_path: Path, arguments: str
) -> None:
    folder = tmp_path / "nothing"
    ended = drivora(*arguments.split(), "--data-dir", folder)
    assert ended.code == ExitCode.USAGE_ERROR
    assert f"no data is stored in {folder}" in ended.err
    assert "--data-dir" in ended.err
    assert "Traceback" not in ended.err
    assert not folder.exists()


def test_a_data_folder_that_is_a_file_is_named(drivora: Drivora, tmp_path: Path) -> None:
    folder = tmp_path / "file"
    folder.touch()
    scenario = tmp_path / "one.json"
    scenario.write_text(json.dumps(SCENARIO))
    ended = drivora("run", scenario, "--workers", "1", "--data-dir", folder)
    assert ended.code == ExitCode.NOT_DONE
    assert f"the data folder {folder} cannot be made" in ended.err
    assert "Traceback" not in ended.err
    assert drivora("runs", "list", "--data-dir", folder).code == ExitCode.USAGE_ERROR


def test_no_command_migrates_the_database_of_a_running_service(
    drivora: Drivora, tmp_path: Path
) -> None:
    folder = tmp_path / "old"
    folder.mkdir()
    path = folder / "drivora.sqlite3"
    with closing(sqlite3.connect(path)) as old:
        old.executescript(REVISION.read_text())
    lock = ServerLock(folder)
    try:
        for arguments in (("runs", "list"), ("store", "migrate")):
            ended = drivora(*arguments, "--data-dir", folder)
            assert ended.code == ExitCode.NOT_DONE
            assert "older version" in ended.err
    finally:
        lock.release()
    with closing(sqlite3.connect(path)) as old:
        assert old.execute("SELECT version_num FROM alembic_version").fetchone() == ("0008",)
    assert drivora("runs", "list", "--data-dir", folder).code == ExitCode.DONE


def test_a_data_folder_and_a_service_are_not_given_together(
    drivora: Drivora, tmp_path: Path
) -> None:
    listed = ("runs", "list", "--data-dir", tmp_path / "x")
    given = drivora(*listed, "--server", NO_SERVICE)
    found = drivora(*listed, DRIVORA_SERVER=NO_SERVICE)
    assert given.code == found.code == ExitCode.USAGE_ERROR
    assert "--server is given" in given.err
    assert "DRIVORA_SERVER is set" in found.err


def test_a_command_logs_what_the_environment_asks_for(drivora: Drivora, tmp_path: Path) -> None:
    arguments = ("validate", tmp_path / "one.json", "--data-dir", tmp_path / "x")
    arguments[1].write_text(json.dumps(SCENARIO))
    quiet = drivora(*arguments)
    told = drivora(*arguments, DRIVORA_LOG_LEVEL="info", DRIVORA_LOG_FORMAT="json")
    assert quiet.code == told.code == ExitCode.DONE
    assert quiet.err == ""
    assert all(json.loads(line) for line in told.err.splitlines())
    assert told.err
