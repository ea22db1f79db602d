"""``drivora seeds rate``."""

from __future__ import annotations

import json
from pathlib import Path

from drivora_service.api.documentation.recorded_examples import SCENARIO
from tests.cli.conftest import Drivora

CAMPAIGN = """
name: mine
tester: {name: avfuzzer}
agent: {name: idm, parameters: {reaction_time: 1.0}}
scenario: {file: crossing.json}
space: {vehicles: 3}
oracles: [discomfort, collision]
budget: {simulations: 7}
"""


def test_rates_are_those_of_a_kept_campaign_of_random_search(
    drivora: Drivora, scenario_file: Path
) -> None:
    campaign = scenario_file.with_name("mine.yaml")
    campaign.write_text(CAMPAIGN)
    ended = drivora(
        *("seeds", "rate", "--campaign", campaign, "--simulations", "12"),
        *("--counts", "any", "--workers", "2", "--json"),
    )
    assert ended.code == 0, ended.err
    told = ended.json()
    (scene,) = told["scenes"]
    assert scene["name"] == "mine"
    assert scene["seed"]["status"] == "finished"
    assert scene["total"]["simulations"] == told["total"]["simulations"] == 12
    assert told["definition"] == "violations of any fault (any), of collision, discomfort"
    kept = drivora("campaign", "show", told["campaign_id"], "--json").json()
    assert (kept["tester"], kept["state"]) == ("random", "finished")
    assert kept["configuration"] == "idm · reaction_time 1.0"
    failing = {one["evaluation"]: one["verdict"]["oracle"] for one in kept["failures"]}
    assert failing, "otherwise this test shows nothing"
    assert scene["total"]["failing"] == len(failing)
    assert scene["oracles"].keys() == {one["verdict"]["oracle"] for one in kept["failures"]}
    for oracle, found in scene["oracles"].items():
        numbers = {o["evaluation"] for o in kept["failures"] if o["verdict"]["oracle"] == oracle}
        assert found["failing"] == len(numbers)
        assert found["low"] < found["rate"] < found["high"]
    assert scene["seed"] == kept["seed_runs"][0]


def test_each_seed_has_a_row_and_a_sentence(drivora: Drivora, tmp_path: Path) -> None:
    for name in ("one", "two"):
        (tmp_path / f"{name}.json").write_text(json.dumps(SCENARIO))
    options = ("--simulations", "3", "--workers", "2", "--agent", "idm")
    ended = drivora("seeds", "rate", "one.json", "two.json", *options)
    assert ended.code == 0, ended.err
    assert "/3 " in ended.out
    assert "/6 " in ended.out
    assert ended.out.count("of 3 fail") == 2


def test_exactly_one_scene_is_needed(drivora: Drivora, scenario_file: Path) -> None:
    assert "no scene is given" in drivora("seeds", "rate").err
    both = drivora("seeds", "rate", scenario_file, "--campaign", scenario_file)
    assert both.code == 2
    assert "not both" in both.err
    unknown = drivora("seeds", "rate", scenario_file, "--agent", "idmm")
    assert unknown.code == 2
    assert "did you mean 'idm'" in unknown.err
