"""Files of Drivora that are no scenarios, named or in a folder of scenarios."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.cli.scenarios.other_files import describe_other_file
from drivora_service.scenario.scenario_schema import schema_directory
from tests.cli.conftest import Drivora

SHIPPED = schema_directory()
MANIFESTS = Path(__file__).parents[3] / "drivora_service" / "agents" / "adapters"
CAMPAIGN = SHIPPED / "examples" / "campaigns" / "deadlock.yaml"


@pytest.mark.parametrize(
    ("path", "words"),
    [
        (CAMPAIGN, "a campaign file: drivora campaign run"),
        (SHIPPED / "examples/studies/two-methods.yaml", "a study file: drivora study run"),
        (SHIPPED / "suites/smoke/suite.yaml", "a suite file: drivora suite run"),
        (SHIPPED / "suites/smoke/idm.baseline.json", "a baseline: drivora suite run SUITE"),
        (SHIPPED / "laws/china.yaml", "a file of traffic laws: drivora laws check"),
        (SHIPPED / "examples/responsibility/cases.json", "a list of cases, not a scenario"),
        (SHIPPED / "study-1.0.schema.json", "a JSON schema, not a scenario"),
        (MANIFESTS / "dilu" / "dilu.yaml", "the manifest of an ADS: drivora agents list"),
    ],
)
def test_shipped_files_are_called_what_they_are(path: Path, words: str) -> None:
    assert describe_other_file(path).startswith(f"is {words}")


@pytest.mark.parametrize(
    "text",
    ["limits: []\nconfirm: 2\n", '{"fail_on": ["new"]}'],
)
def test_a_gate_is_recognised_by_any_key_of_its_own(tmp_path: Path, text: str) -> None:
    path = tmp_path / "gate.yaml"
    path.write_text(text)
    assert "a gate file: drivora suite run SUITE --gate-file" in describe_other_file(path)


@pytest.mark.parametrize(
    "text",
    [
        json.dumps(SCENARIO),
        json.dumps({**SCENARIO, "name": "x", "tester": "y", "budget": 1, "scenario": 1}),
        "ego_vehicles: []\ncases: 1\n",
        "{",
        "[1, 2]",
        "",
        "- a\n",
        "  tester: 1\n  budget: 2\n  scenario: 3\n",
    ],
)
def test_scenarios_and_unknown_files_are_not(tmp_path: Path, text: str) -> None:
    path = tmp_path / "file.json"
    path.write_text(text)
    assert describe_other_file(path) == ""


def test_a_folder_is_run_without_them(drivora: Drivora, tmp_path: Path) -> None:
    folder = tmp_path / "mixed"
    (folder / "cases").mkdir(parents=True)
    (folder / "one.json").write_text(json.dumps({**SCENARIO, "max_sim_time": 1.0}))
    (folder / "cases" / "two.json").write_text(json.dumps({**SCENARIO, "max_sim_time": 1.0}))
    shutil.copy(CAMPAIGN, folder)
    ended = drivora("run", folder, "--workers", "1")
    assert ended.code == 0
    named = folder / "deadlock.yaml"
    assert f"skipped: {named} is a campaign file: drivora campaign run {named}" in ended.err
    counted = f"2 scenarios in 2 folders: 1 in {folder / 'cases'}, 1 in {folder}"
    assert counted in ended.err
    assert "invalid" not in ended.out

    checked = drivora("validate", folder)
    assert checked.code == 0
    assert checked.out.count(": valid") == 2
    assert f"skipped: {named} is a campaign file" in checked.err


def test_a_file_that_is_named_is_refused_with_its_command(drivora: Drivora, tmp_path: Path) -> None:
    words = f"{CAMPAIGN} is a campaign file: drivora campaign run {CAMPAIGN}"
    ended = drivora("run", CAMPAIGN)
    assert (ended.code, ended.out, ended.err.strip()) == (2, "", words)
    checked = drivora("validate", CAMPAIGN)
    assert (checked.code, checked.out, checked.err.strip()) == (1, "", words)
    shutil.copy(CAMPAIGN, tmp_path)
    only = drivora("run", tmp_path)
    assert only.code == 2
    assert f"no scenario in {tmp_path}" in only.err
