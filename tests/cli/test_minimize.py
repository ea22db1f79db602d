"""``drivora minimize`` as users run it."""

from __future__ import annotations

import json
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
