"""The shipped study files compare methods on common ground."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

from benchmarks.methods import METHODS, installed_methods
from benchmarks.reference_scene import add_driven_paths
from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.document.campaign_reading import read_campaign
from drivora_service.campaigns.search.search_preparation import prepare_search
from drivora_service.cli.studies.study_files import read_study_file
from drivora_service.studies.study_reading import read_study


def installed(file: Path, wanted: Sequence[str] = METHODS) -> dict[str, Any]:
    """Returns the content of a study file with those of some methods that are installed."""
    content = read_study_file(file).content
    methods, _ = installed_methods(wanted)
    kept = [one for one in content["methods"] if one["name"] in methods]
    return {**content, "methods": kept, "repetitions": 1}


def test_nine_methods_search_the_same_on_common_ground(
    repository: Path, catalogues: Catalogues
) -> None:
    file = repository / "benchmarks" / "studies" / "nine-methods.yaml"
    methods = read_study_file(file).content["methods"]
    labels = {one.get("label", one["name"]) for one in methods if one.get("feedback") is None}
    twins = {one["name"] for one in methods if one.get("feedback") == "shuffled"}
    assert labels - {"deepcollision without feedback"} == set(METHODS) - {"doppeltest"}
    assert twins == set(METHODS) - {"random", "doppeltest", "deepcollision"}
    study = read_study(installed(file), catalogues)
    # Only the tester and the name differ between the methods.
    common: dict[str, set[str]] = {}
    for campaign in study.campaigns:
        assert campaign.cell is not None
        document = json.loads(campaign.document)
        rest = {key: value for key, value in document.items() if key not in ("name", "tester")}
        common.setdefault(campaign.cell.scenario, set()).add(json.dumps(rest, sort_keys=True))
    assert len(common) == 3
    assert all(len(found) == 1 for found in common.values())


@pytest.mark.parametrize("suffix", ["", "-sumo-krauss"])
def test_variants_of_methods_search_on_the_same_ground(suffix: str, repository: Path) -> None:
    studies = repository / "benchmarks" / "studies"
    own = {"name", "methods", "repetitions"}
    nine, variants = (
        read_study_file(studies / f"{name}{suffix}.yaml").content
        for name in ("nine-methods", "variants")
    )
    assert {k: v for k, v in variants.items() if k not in own} == {
        k: v for k, v in nine.items() if k not in own
    }
    assert {one["name"] for one in variants["methods"]} <= set(METHODS)


def test_variants_of_lawbreaker_search_on_its_ground(repository: Path) -> None:
    studies = repository / "benchmarks" / "studies"
    laws, variants = (
        read_study_file(studies / f"{name}.yaml").content
        for name in ("law-coverage", "law-variants")
    )
    assert all(scenario in laws["scenarios"] for scenario in variants["scenarios"])
    for key in ("agents", "budget", "oracles"):
        assert variants[key] == laws[key]
    assert {one["name"] for one in variants["methods"]} == {"lawbreaker"}


def test_a_slow_ads_is_searched_by_all_methods_of_one_ego(repository: Path) -> None:
    content = read_study_file(repository / "benchmarks" / "studies" / "slow-ads.yaml").content
    assert {one["name"] for one in content["methods"]} == set(METHODS) - {"doppeltest"}


def test_the_twin_of_deepcollision_draws_all_actions(repository: Path) -> None:
    content = read_study_file(repository / "benchmarks" / "studies" / "nine-methods.yaml").content
    own, twin = (one for one in content["methods"] if one["name"] == "deepcollision")
    assert (twin["label"], "feedback" in twin) == ("deepcollision without feedback", False)
    drawn = {"first_exploration": 1.0, "last_exploration": 1.0}
    assert {**own["parameters"], **drawn} == twin["parameters"]


@pytest.mark.parametrize("method", METHODS)
def test_every_method_can_begin_on_every_scene(
    method: str, repository: Path, catalogues: Catalogues
) -> None:
    if method == "deepcollision":
        pytest.importorskip("stable_baselines3", reason="an extra: `adversary`")
    name = "several-egos" if method == "doppeltest" else "nine-methods"
    file = repository / "benchmarks" / "studies" / f"{name}.yaml"
    study = read_study(installed(file, [method]), catalogues)
    assert len(study.campaigns) == (3 if method == "random" else 6)
    for campaign in study.campaigns:
        search = prepare_search(
            read_campaign(campaign.document, catalogues), catalogues, run_prefix="study"
        )
        assert all(part.tester.ask(1) for part in search.parts)


def test_needless_detours_are_judged_for_all_methods(
    repository: Path, catalogues: Catalogues
) -> None:
    file = read_study_file(repository / "benchmarks" / "studies" / "needless-detours.yaml")
    study = read_study({**file.content, "repetitions": 1}, catalogues)
    assert study.document.oracles == ("non_optimal_decision",)
    (agent,) = study.document.agents
    assert len(study.document.scenarios) == 3
    for scene in study.document.scenarios:
        content = json.loads(scene.document.model_dump_json())
        # The scene has the path that the ADS takes in it now.
        written = [ego.pop("reference_path") for ego in content["ego_vehicles"]]
        driven = json.loads(add_driven_paths(content, agent.name))
        for path, ego in zip(written, driven["ego_vehicles"], strict=True):
            now = [(pose["time"], pose["x"], pose["y"]) for pose in ego["reference_path"]]
            assert [(pose["time"], pose["x"], pose["y"]) for pose in path] == [
                pytest.approx(pose, abs=0.01) for pose in now
            ]
            assert ego["agent"]["name"] == agent.name
