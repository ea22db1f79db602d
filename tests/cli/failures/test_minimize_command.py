"""``drivora minimize`` as users run it."""

from __future__ import annotations

import json
import os
import shutil
import signal
import sqlite3
import time
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from tests.cli.conftest import Drivora, Ended
from tests.command_process import Begun, begin
from tests.oracles.installing import PACKAGE, install_oracles
from tests.suites.minimization.crowded_crash import ONLY_NEEDED, crowded_crash


@pytest.fixture(scope="module")
def crashed(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """A data folder with a run that fails, and the id of the run."""
    folder = tmp_path_factory.mktemp("crashed")
    (folder / "crash.json").write_text(json.dumps(crowded_crash()))
    out, err = folder / "out", folder / "err"
    command = ("run", "crash.json", "--json", "--data-dir", folder / "data")
    begun = begin(*command, folder=folder, environment=os.environ, out=out, err=err)
    assert begun.wait(120.0) == 0, err.read_text()
    return folder / "data", json.loads(out.read_text())["id"]


@pytest.fixture
def run_id(crashed: tuple[Path, str], tmp_path: Path) -> str:
    """A run that fails, in the data folder of the test."""
    data, found = crashed
    shutil.copytree(data, tmp_path / "data")
    return found


def actors(document: dict[str, Any]) -> set[str]:
    lists = ("ego_vehicles", "npc_vehicles", "npc_walkers", "npc_obstacles")
    return {actor["id"] for key in lists for actor in document.get(key, ())}


@pytest.mark.slow(seconds=15)
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


@pytest.mark.slow
def test_a_run_whose_oracle_is_not_installed_any_more_is_refused_before_it_is_run(
    drivora: Drivora, tmp_path: Path
) -> None:
    file = tmp_path / "fast.json"
    file.write_text(json.dumps({**SCENARIO, "max_sim_time": 8.0}))
    with pytest.MonkeyPatch.context() as patch:
        install_oracles(tmp_path / "site", patch, "top_speed")
        run = drivora("run", file, "--workers", "1", "--json").json()["id"]
    ended = drivora("minimize", run, "--oracle", "top_speed")
    assert ended.code == 2
    assert ended.err.startswith(
        f"run {run} cannot fail again here: oracle 'top_speed' is not installed; it was made with "
        f"{PACKAGE} 1.0, not installed here: install it again"
    )
    rejudged = drivora("rejudge", run)
    assert rejudged.code == 3
    assert "Oracle top_speed is not installed; traces that it judged before: 1" in rejudged.out
    assert "Traces: 1; compared: 1; changed: 0; damaged: 0" in rejudged.out


def begun(data: Path, run: str, log: Path, more_than: int) -> tuple[Begun, str]:
    """Begins the command; returns it and the id that it prints once it has simulated more."""
    process = begin(
        *("minimize", run, "--data-dir", data),
        folder=log.parent,
        environment=dict(os.environ),
        out=log,
        err=log,
    )
    until = time.monotonic() + 120.0
    while True:
        first, ended, _ = (log.read_text() if log.exists() else "").partition("\n")
        if ended and simulations(data, first.split()[-1]) > more_than:
            return process, first.split()[-1]
        assert time.monotonic() < until
        time.sleep(0.01)


def simulations(data: Path, minimization: str) -> int:
    """Returns how many simulations a stored minimisation has."""
    query = "SELECT json_extract(progress, '$.simulations') FROM minimizations WHERE id = ?"
    with closing(sqlite3.connect(data / "drivora.sqlite3")) as connection:
        return int(connection.execute(query, [minimization]).fetchone()[0])


@pytest.mark.slow(seconds=15)
def test_the_same_command_goes_on_where_one_was_ended(
    drivora: Drivora, run_id: str, tmp_path: Path
) -> None:
    """Interrupted at first, and killed later on."""
    data = tmp_path / "data"
    process, minimization = begun(data, run_id, tmp_path / "first.log", 2)
    process.send_signal(signal.SIGTERM)
    assert process.wait(60.0) == 130
    assert "the same command goes on" in (tmp_path / "first.log").read_text()
    told = simulations(data, minimization)
    process, again_id = begun(data, run_id, tmp_path / "second.log", told)
    process.send_signal(signal.SIGKILL)
    assert process.wait(60.0) == -signal.SIGKILL
    assert again_id == minimization
    assert simulations(data, minimization) > told > 2
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
