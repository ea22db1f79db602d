"""Packages with broken oracles and testers: what a campaign, a study and a suite say of them."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from tests.cli.conftest import Drivora
from tests.oracles.installing import PACKAGE, install_oracles

REASON = f"oracle 'moody' of the package '{PACKAGE}' raised ZeroDivisionError: in a bad mood"
REPAIR = f"repair or uninstall the package '{PACKAGE}' (pip uninstall {PACKAGE})"
CAMPAIGN = {
    "name": "unjudged",
    "tester": {"name": "random"},
    "agent": {"name": "idm"},
    "scenario": {"file": "crossing.json"},
    "budget": {"simulations": 2},
    "workers": 1,
}


def reason(tmp_path: Path) -> str:
    """Why no run is judged, with the line that raises."""
    file = tmp_path / "site" / "foreign_oracles.py"
    lines = file.read_text().splitlines()
    (line,) = (n for n, text in enumerate(lines, 1) if "raise ZeroDivisionError" in text)
    return f"{REASON} ({file}, line {line})"


@pytest.fixture
def scenario(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A scenario whose runs the broken oracle cannot judge: it raises for an ego of this name."""
    install_oracles(tmp_path / "site", monkeypatch, "moody")
    ego = {**SCENARIO["ego_vehicles"][0], "id": "raises"}
    path = tmp_path / "crossing.json"
    path.write_text(json.dumps({**SCENARIO, "ego_vehicles": [ego], "max_sim_time": 2.0}))
    return path


@pytest.mark.slow
def test_a_campaign_that_judged_nothing_names_the_package_and_exits_with_3(
    drivora: Drivora, scenario: Path, tmp_path: Path
) -> None:
    file, why = tmp_path / "campaign.json", reason(tmp_path)
    file.write_text(json.dumps(CAMPAIGN))
    ended = drivora("campaign", "run", file)
    assert ended.code == 3
    assert f"2 runs without a result: {why}" in ended.out
    assert f"nothing was judged: 2 runs without a result: {why}\n{REPAIR}" in ended.err
    assert "resume it" not in ended.err
    # A gate does not decide on runs that say nothing about the ADS.
    gated = drivora("campaign", "run", file, "--gate")
    assert (gated.code, "gate" in gated.err) == (3, False)

    (newest, _) = drivora("campaign", "list", "--json").json()
    shown = drivora("campaign", "show", newest["id"], "--json").json()
    assert shown["missing_results"] == [
        {
            "status": "plugin_failed",
            "cause": "oracle_raised",
            "message": why,
            "evaluation": 0,
            "runs": 2,
        }
    ]
    report = drivora("campaign", "report", newest["id"]).out
    assert f"| runs without a result | 2: {why} |" in report

    study = {
        **{key: CAMPAIGN[key] for key in ("name", "workers", "budget")},
        "scenarios": ["crossing.json"],
        "agents": [{"name": "idm"}],
        "methods": [{"name": "random"}],
    }
    file.write_text(json.dumps(study))
    ended = drivora("study", "run", file)
    assert ended.code == 3
    assert f"2 runs without a result: {why}" in ended.out
    assert REPAIR in ended.err


def test_a_suite_that_judged_nothing_names_the_package_and_exits_with_3(
    drivora: Drivora, scenario: Path, tmp_path: Path
) -> None:
    why = reason(tmp_path)
    ended = drivora("suite", "run", scenario, "--workers", "1")
    assert ended.code == 3
    assert ended.err.splitlines()[-1] == f"1 run was not judged: {why}"
