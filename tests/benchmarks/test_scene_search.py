from __future__ import annotations

import json
from pathlib import Path

import pytest

from benchmarks.scene_search.__main__ import STAGES, Ledger, is_wanted, of_laws
from benchmarks.scene_search.counting import Counts
from benchmarks.scene_search.laws import ShownWays, choose_scenes
from benchmarks.scene_search.scenes import failing_scenes
from drivora_service.cli.studies.study_files import read_study_file


@pytest.mark.parametrize("study", ["nine-methods", "nine-methods-sumo-krauss"])
def test_the_scenes_of_a_study_are_those_that_were_found(study: str, repository: Path) -> None:
    benchmarks = repository / "benchmarks"
    content = read_study_file(benchmarks / "studies" / f"{study}.yaml").content
    (agent,) = (one["name"] for one in content["agents"])
    found = {scene.name: scene for scene in failing_scenes() if scene.agent == agent}
    ledger = Ledger(benchmarks / "results" / "scene_search")
    for entry in content["scenarios"]:
        scene = found[entry["label"]]
        assert entry["space"] == scene.space
        assert entry["document"] == json.loads(json.dumps(scene.scenario))
        counts = ledger.get(scene, STAGES[-1])
        assert counts is not None
        assert is_wanted(counts)


def test_the_interval_is_that_of_clopper_and_pearson() -> None:
    low, high = Counts(judged=2000, avoidable=10).interval
    # No success: 1 - 0.025 ** (1 / n).
    assert Counts(judged=100).interval == pytest.approx((0.0, 1.0 - 0.025**0.01))
    assert (low, high) == pytest.approx((0.0024, 0.0092), abs=1e-4)


def test_the_scenes_of_the_study_of_laws_are_those_that_were_found(repository: Path) -> None:
    benchmarks = repository / "benchmarks"
    content = read_study_file(benchmarks / "studies" / "law-coverage.yaml").content
    found = of_laws(benchmarks / "results" / "scene_search" / "laws.jsonl")
    entries = {entry["label"]: entry for entry in content["scenarios"]}
    assert entries.keys() == {scene.name for scene in found}
    for scene in found:
        assert entries[scene.name]["space"] == scene.space
        assert entries[scene.name]["document"] == json.loads(json.dumps(scene.scenario))


def shown(scene: str, **ways: int) -> ShownWays:
    """Returns ways that draws of a scene have shown."""
    return ShownWays(scene=scene, agent="sumo-krauss", judged=200, ways=ways)


def test_of_each_network_the_scene_with_most_rare_ways_is_taken() -> None:
    counted = [
        shown("a 0, traffic", common=40, rare=2, rarer=1),
        shown("a 1, traffic", common=3, rare=1),
        shown("b 0, traffic", rare=1, also=1, third=2),
        shown("c 0, traffic", common=50),
    ]
    assert [one.scene for one in choose_scenes(counted, 3)] == ["b 0, traffic", "a 0, traffic"]


def test_the_ways_that_a_campaign_is_expected_to_show() -> None:
    ways = shown("a 0, traffic", always=200, rare=1)
    assert ways.expected_ways(1) == pytest.approx(1.005)
    # 1 - (199 / 200) ** 300
    assert ways.expected_ways(300) == pytest.approx(1.7777, abs=1e-4)
