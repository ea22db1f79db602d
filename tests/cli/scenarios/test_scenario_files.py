from __future__ import annotations

import json
from pathlib import Path

import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.cli.scenarios.scenario_files import read_files
from drivora_service.errors import ConfigurationError

CAMPAIGN = {"tester": "random", "budget": 40, "failures": []}


def test_a_folder_of_findings_gives_its_scenarios_only(tmp_path: Path) -> None:
    (tmp_path / "000007.json").write_text(json.dumps(SCENARIO))
    (tmp_path / "campaign.json").write_text(json.dumps(CAMPAIGN))
    (tmp_path / "000007.report.json").write_text("{}")
    scenarios, unreadable = read_files([tmp_path], agent="")
    assert [scenario.name for scenario in scenarios] == ["000007"]
    assert not unreadable


def test_a_file_of_results_that_is_named_is_called_what_it_is(tmp_path: Path) -> None:
    path = tmp_path / "campaign.json"
    path.write_text(json.dumps(CAMPAIGN))
    scenarios, (unreadable,) = read_files([path], agent="")
    assert not scenarios
    assert "holds the results of a command" in unreadable.problems[0].message


def test_a_scenario_may_have_any_name(tmp_path: Path) -> None:
    path = tmp_path / "campaign.json"
    path.write_text(json.dumps(SCENARIO))
    assert len(read_files([tmp_path], agent="")[0]) == 1


def test_a_folder_of_results_only_is_refused_by_name(tmp_path: Path) -> None:
    (tmp_path / "campaign.json").write_text(json.dumps(CAMPAIGN))
    with pytest.raises(ConfigurationError, match=r"results and no scenario: campaign\.json"):
        read_files([tmp_path], agent="")
