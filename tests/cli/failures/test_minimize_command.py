"""``drivora minimize`` as users run it."""

from __future__ import annotations

import json
import signal
import sqlite3
import subprocess
import sys
import time
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from tests.cli.conftest import Drivora, Ended
from tests.suites.minimization.crowded_crash import ONLY_NEEDED, crowded_crash


@pytest.fixture
def run_id(drivora: Drivora, tmp_path: Path) -> str:
    """A run that fails, in the data folder of the test."""
    file = tmp_path / "crash.json"
    file.write_text(json.dumps(crowded_crash()))
    ended = drivora("run", file, "--json")
    assert ended.code == 0, ended.err
    found: str = ended.json()["id"]
    return found


def actors(document: dict[str, Any]) -> set[str]:
    lists = ("ego_vehicles", "npc_vehicles", "npc_walkers", "npc_obstacles")
    return {actor["id"] for key in lists for actor in document.get(key, ())}


@pytest.mark.slow(seconds=40)
def test_the_smallest_scenario_is_printed_written_and_drawn(
    drivora: Drivora, run_id: str, tmp_path: Path
) -> None:
    folder = tmp_path / "smaller"
    ended = drivora("minimize", run_id, "--out", folder)
    assert ended.code == 0, ended.err
    lines = [line.split() for line in ended.out.splitlines()]
    assert ["actors", "4", "2"] in lines
    assert "every single reduction was tried" in ended.out
    assert sorted(path.name for path in folder.iterdir()) == [
        "minimal.json",
        "minimization.json",
        "side-by-side.svg",
    ]
    assert (folder / "side-by-side.svg").read_text().count("<svg") == 1
    assert actors(json.loads((folder / "minimal.json").read_text())) == ONLY_NEEDED
    report = json.loads((folder / "minimization.json").read_text())
    # The same again, with one worker: nothing of the result differs.
    other = tmp_path / "other.json"
    alone = drivora("minimize", run_id, "--workers", "1", "--out", other, "--json")
    assert alone.code == 0, alone.err
    for name in ("document", "decided", "one_minimal", "removed", "before", "after", "failure"):
        assert alone.json()[name] == report[name]
    assert other.read_text() == (folder / "minimal.json").read_text()
    # And a run of the file fails in the same way.
    again = drivora("run", other, "--json").json()
    collisions = [
        verdict
        for verdict in again["verdicts"]
        if (verdict["oracle"], verdict["outcome"]) == ("collision", "violated")
    ]
    assert [verdict["at_fault"] for verdict in collisions] == [True]


@pytest.mark.slow(seconds=15)
def test_a_budget_that_ends_before(drivora: Drivora, run_id: str) -> None:
    ended = drivora("minimize", run_id, "--budget", "2", "--json")
    assert ended.code == 1
    found = ended.json()
    assert (found["state"], found["decided"], found["one_minimal"]) == ("finished", 2, False)
    assert "raise --budget" in ended.err


@pytest.mark.slow(seconds=10)
def test_what_cannot_be_minimised(drivora: Drivora, run_id: str) -> None:
    def refused(*arguments: str) -> Ended:
        ended = drivora("minimize", *arguments)
        assert ended.code == 2
        return ended

    assert "does not violate red_light" in refused(run_id, "--oracle", "red_light").err
    assert "unknown run '0'" in refused("0").err
    assert "--out" in refused(run_id, "--out", "/proc/none/smaller").err


def started(data: Path, run: str) -> tuple[subprocess.Popen[str], str]:
    """Starts the command; returns it, and the id that it prints, once a simulation has ended."""
    process = subprocess.Popen(
        [sys.executable, "-m", "drivora_service.cli", "minimize", run, "--data-dir", str(data)],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stderr is not None
    minimization = process.stderr.readline().split()[-1]
    with closing(sqlite3.connect(data / "drivora.sqlite3")) as connection:
        query = "SELECT json_extract(progress, '$.simulations') FROM minimizations WHERE id = ?"
        until = time.monotonic() + 60.0
        while connection.execute(query, [minimization]).fetchone()[0] < 3:
            assert time.monotonic() < until
            time.sleep(0.01)
    return process, minimization


@pytest.mark.slow(seconds=60)
@pytest.mark.parametrize(("number", "code"), [(signal.SIGTERM, 3), (signal.SIGKILL, -9)])
def test_the_same_command_goes_on_where_one_was_ended(
    drivora: Drivora, run_id: str, tmp_path: Path, number: signal.Signals, code: int
) -> None:
    data = tmp_path / "data"
    process, minimization = started(data, run_id)
    process.send_signal(number)
    _, printed = process.communicate(timeout=60)
    assert process.returncode == code
    assert number is signal.SIGKILL or "the same command goes on" in printed
    ended = drivora("minimize", run_id, "--json")
    assert ended.code == 0, ended.err
    again = ended.json()
    assert again["id"] == minimization
    fresh = drivora("minimize", run_id, "--json").json()
    assert fresh["id"] != minimization
    for name in ("document", "decided", "one_minimal", "removed", "before", "after"):
        assert again[name] == fresh[name]
    runs = drivora("runs", "list", "--batch", again["batch_id"], "--json").json()
    finished = [run["id"] for run in runs if run["status"] == "finished"]
    assert len(finished) == len(set(finished)) == again["simulations"]
