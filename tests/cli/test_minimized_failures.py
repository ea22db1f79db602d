"""A failure that a campaign finds is minimised, and other code checks what came of it.

The smallest scenario is run anew by ``drivora run``, and so is every scenario with one thing fewer,
made here from its JSON: none of them may fail in the same way.
"""

from __future__ import annotations

import copy
import json
import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest
import yaml

from tests.cli.conftest import Drivora

CAMPAIGNS = Path(__file__).parents[2] / "openscenario_schemas" / "examples" / "campaigns"
_LISTS = ("ego_vehicles", "npc_vehicles", "npc_walkers", "npc_obstacles")


def found_failures(drivora: Drivora, tmp_path: Path, name: str, budget: int) -> list[str]:
    """Runs an example campaign with a smaller budget; returns the ids of failing runs."""
    content = yaml.safe_load((CAMPAIGNS / f"{name}.yaml").read_text())
    scenario = CAMPAIGNS / content["scenario"]["file"]
    content |= {"budget": {"simulations": budget}, "scenario": {"file": str(scenario)}}
    file = tmp_path / "campaign.json"
    file.write_text(json.dumps(content))
    ended = drivora("campaign", "run", file, "--json")
    assert ended.code == 0, ended.err
    campaign = ended.json()
    return [f"{campaign['id']}-{one['evaluation']}" for one in campaign["failures"]]


def same(failure: Mapping[str, Any], document: Mapping[str, Any], run: Mapping[str, Any]) -> bool:
    """Whether a run fails in the same way, told from its JSON."""
    roles = {
        actor["id"]: {"ego_vehicles": "ego"}.get(key, key.removesuffix("s"))
        for key in _LISTS
        for actor in document.get(key, ())
    }
    return any(
        verdict["outcome"] == "violated"
        and verdict["oracle"] == failure["oracle"]
        and verdict["ego"] == failure["ego"]
        and verdict["at_fault"] is True
        and verdict["avoidable"]
        == {"avoidable": "yes", "unavoidable": "no"}[failure["accountability"]]
        and roles.get(verdict["counterpart"]) == failure["counterpart_role"]
        and math.dist(verdict["location"], failure["location"]) <= 10.0
        for verdict in run["verdicts"]
    )


def with_one_thing_fewer(document: dict[str, Any], ego: str) -> Iterator[tuple[str, Any]]:
    """Every document without one actor, waypoint, optional value or weather value."""
    for key in _LISTS:
        for index, actor in enumerate(document.get(key, ())):
            if actor["id"] != ego:
                less = copy.deepcopy(document)
                del less[key][index]
                yield f"no-{actor['id']}", less
            for name in {"start_time", "initial_speed", "behavior", "dynamics"} & actor.keys():
                less = copy.deepcopy(document)
                del less[key][index][name]
                yield f"{actor['id']}-no-{name}", less
            for number, place in enumerate(actor.get("route", ())):
                if key == "npc_vehicles" and len(actor["route"]) > 1:
                    less = copy.deepcopy(document)
                    del less[key][index]["route"][number]
                    yield f"{actor['id']}-no-place-{number}", less
                for name in {"yaw", "speed"} & place.keys():
                    less = copy.deepcopy(document)
                    del less[key][index]["route"][number][name]
                    yield f"{actor['id']}-place-{number}-no-{name}", less
    for name in document.get("weather", ()):
        less = copy.deepcopy(document)
        del less["weather"][name]
        yield f"no-{name}", less


@pytest.mark.slow(seconds=120)
@pytest.mark.parametrize(("campaign", "budget", "oracle"), [("late-braking", 40, "collision")])
def test_a_failure_that_a_campaign_found(
    drivora: Drivora,
    tmp_path: Path,
    campaign: str,
    budget: int,
    oracle: str,
) -> None:
    run = found_failures(drivora, tmp_path, campaign, budget)[0]
    ended = drivora("minimize", run, "--oracle", oracle, "--json")
    assert ended.code == 0, ended.err
    result = ended.json()
    failure, document = result["failure"], result["document"]
    assert result["one_minimal"] is True
    assert result["after"]["actors"] < result["before"]["actors"]
    assert result["after"]["digits"] < result["before"]["digits"] / 2

    original = json.loads(drivora("runs", "scenario", result["reproduction_run_id"]).out)
    folder = tmp_path / "scenarios"
    folder.mkdir()
    (folder / "original.json").write_text(json.dumps(original))
    (folder / "smallest.json").write_text(json.dumps(document))
    fewer = dict(with_one_thing_fewer(document, failure["ego"]))
    assert len(fewer) > 4
    for name, less in fewer.items():
        (folder / f"{name}.json").write_text(json.dumps(less))
    # A scenario that cannot be run is none that fails: the command tells it by its exit code.
    told = {
        Path(one["scenario"]).stem: one for one in drivora("run", folder, "--json").json()["runs"]
    }
    assert told.keys() == {"original", "smallest", *fewer}
    assert same(failure, original, told["original"])
    assert same(failure, document, told["smallest"])
    for name, less in fewer.items():
        if told[name].get("status") == "finished":
            assert not same(failure, less, told[name]), name
