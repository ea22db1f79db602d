"""Campaign files that name their scenarios by files and folders."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.cli.campaigns.campaign_files import read_campaign_file
from drivora_service.errors import InvalidDocument


def campaign(folder: Path, scenario: str) -> Path:
    path = folder / "campaign.yaml"
    path.write_text(f"name: all\nscenario: {scenario}\n")
    return path


def test_the_scenarios_of_a_folder_are_named_after_their_files(tmp_path: Path) -> None:
    seeds = tmp_path / "seeds" / "deep"
    seeds.mkdir(parents=True)
    for name in ("b", "a"):
        (seeds / f"{name}.json").write_text(json.dumps(SCENARIO))
    content = read_campaign_file(campaign(tmp_path, "{folder: seeds}"))
    assert "scenario" not in content
    assert [one["name"] for one in content["scenarios"]] == ["a", "b"]
    assert all(one["scenario"]["ego_vehicles"] for one in content["scenarios"])


@pytest.mark.parametrize(
    ("scenario", "said"),
    [
        ("{folder: none}", "there is no folder"),
        ("{folder: ''}", "found no name"),
        ("{folder: empty}", "holds no scenario file"),
        ("{folder: broken}", "broken.json"),
    ],
)
def test_a_folder_that_cannot_be_read_is_a_problem_at_its_place(
    tmp_path: Path, scenario: str, said: str
) -> None:
    (tmp_path / "empty").mkdir()
    (tmp_path / "broken").mkdir()
    (tmp_path / "broken" / "broken.json").write_text("{")
    with pytest.raises(InvalidDocument) as caught:
        read_campaign_file(campaign(tmp_path, scenario))
    (problem, *_) = caught.value.problems
    assert problem.pointer == "/scenario/folder"
    assert said in problem.message
