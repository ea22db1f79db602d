from __future__ import annotations

import json
from pathlib import Path

import pytest

from benchmarks.scene_search.__main__ import STAGES, Ledger, is_wanted
from benchmarks.scene_search.counting import Counts
from benchmarks.scene_search.scenes import failing_scenes
from drivora_service.cli.study_files import read_study_file


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
