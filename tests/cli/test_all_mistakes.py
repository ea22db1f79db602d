"""The mistakes of all files that a command is given, named at once."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from tests.cli.conftest import Drivora

CAMPAIGN = """
name: wrong
tester: {name: samot}
agent: {name: idmm}
scenario: {file: crosing.json}
budget: {simulatons: 10}
oracles: [colision]
sed: 7
workers: -3
"""
STUDY = """
name: wrong
scenarios:
  - {file: crosing.json, labl: a}
  - bad.json
  - "no*.json"
  - {file: crossing.json, space: {vehicle: 3}}
agents: [{name: idmm}]
methods: [{name: samot}, {name: random, parameters: {nope: 1}}]
repetitons: 3
budget: {simulations: 0}
oracles: [colision]
"""
SUITE = """
name: wrong
scenarios: [crosing.json, bad.json, crossing.json]
counts: anyy
oracles: [colision]
"""
GATE = "{failing_runs: no, limit: 3}"


@pytest.fixture
def folder(tmp_path: Path, scenario_file: Path) -> Path:
    """A folder with a scenario, and one that has three mistakes."""
    bad: dict[str, Any] = json.loads(json.dumps(SCENARIO))
    ego = bad["ego_vehicles"][0]
    ego["initial_sped"] = ego.pop("initial_speed", 5.0)
    ego["agent"] = {"name": "idmm"}
    bad["map_region"]["town"] = "tee-twn"
    (tmp_path / "bad.json").write_text(json.dumps(bad))
    assert scenario_file.parent == tmp_path
    return tmp_path


def places(printed: str) -> list[str]:
    """The places of the problems that were printed, each of a line of its own."""
    return [line.split(": ")[0].strip() for line in printed.splitlines() if line.startswith("  /")]


def test_a_missing_scenario_hides_no_mistake_of_a_campaign(drivora: Drivora, folder: Path) -> None:
    (folder / "campaign.yaml").write_text(CAMPAIGN)
    ended = drivora("campaign", "run", "campaign.yaml")
    assert ended.code == 2
    assert places(ended.err) == [
        "/tester/name",
        "/agent/name",
        "/scenario/file",
        "/budget/simulatons",
        "/budget/simulations",
        "/oracles/0",
        "/sed",
        "/workers",
    ]
    for meant in ("samota", "idm", "crossing.json", "simulations", "collision", "seed"):
        assert f"did you mean '{meant}'?" in ended.err
    assert "no data is stored" in drivora("campaign", "list").err


def test_a_missing_scenario_hides_no_mistake_of_a_study(drivora: Drivora, folder: Path) -> None:
    (folder / "study.yaml").write_text(STUDY)
    ended = drivora("study", "run", "study.yaml")
    assert ended.code == 2
    assert places(ended.err) == [
        "/scenarios/0",
        "/scenarios/0/labl",
        "/scenarios/1",
        "/scenarios/1",
        "/scenarios/1",
        "/scenarios/2",
        "/scenarios/3/space/vehicle",
        "/agents/0/name",
        "/methods/0/name",
        "/methods/1/parameters/nope",
        "/repetitons",
        "/budget/simulations",
        "/oracles/0",
    ]
    assert "bad.json: /map_region/town: unknown town 'tee-twn'" in ended.err


def test_the_mistakes_of_a_suite_and_its_gate_are_named_together(
    drivora: Drivora, folder: Path
) -> None:
    (folder / "suite.yaml").write_text(SUITE)
    (folder / "gate.yaml").write_text(GATE)
    ended = drivora("suite", "run", "suite.yaml", "--gate-file", "gate.yaml")
    assert ended.code == 2
    of_suite, _, of_gate = ended.err.partition("gate.yaml: ")
    assert of_suite.startswith("suite.yaml: 4 problem(s)")
    assert places(of_suite) == ["/scenarios/0", "/scenarios/1", "/counts", "/oracles/0"]
    assert "/limit" in of_gate


def test_a_missing_file_hides_no_mistake_of_the_others(drivora: Drivora, folder: Path) -> None:
    ended = drivora("run", "crosing.json", "bad.json", "gone.json")
    assert ended.code == 2
    assert "there is no file crosing.json; did you mean 'crossing.json'?" in ended.err
    assert "there is no file gone.json\n" in ended.err
    assert "bad.json: /ego_vehicles/0/initial_sped: " in ended.err
    checked = drivora("validate", "crosing.json", "bad.json", "--json")
    assert checked.code == 1
    found = {one["file"]: len(one["problems"]) for one in checked.json()["results"]}
    assert found == {"crosing.json": 1, "bad.json": 3}


def test_a_run_names_all_that_is_wrong_with_a_scenario(drivora: Drivora, folder: Path) -> None:
    ended = drivora("run", "bad.json")
    assert ended.code == 3
    assert sorted(places(ended.out)) == [
        "/ego_vehicles/0/agent/name",
        "/ego_vehicles/0/initial_sped",
        "/map_region/town",
    ]


def test_a_unit_in_place_of_a_number_and_a_negative_time(drivora: Drivora, folder: Path) -> None:
    wrong = json.loads((folder / "crossing.json").read_text())
    wrong["ego_vehicles"][0]["initial_speed"] = "50 km/h"
    wrong["max_sim_time"] = -5
    (folder / "wrong.json").write_text(json.dumps(wrong))
    ended = drivora("validate", "wrong.json")
    assert "found text '50 km/h'; a number is needed, without a unit: it is in m/s" in ended.out
    assert "/max_sim_time: found -5; it should be greater than or equal to 1" in ended.out
