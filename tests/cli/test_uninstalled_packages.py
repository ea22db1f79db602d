"""What is stored is read and compared without the packages that made it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from tests.cli.conftest import Drivora
from tests.installed_parts import install_parts, uninstall_parts

LAW = """\
laws:
  - name: never_moves
    title: It never moves
    source: the tests
    description: The ego moves.
    severity: minor
    formula: always (speed < 5)
"""
ORACLES = ["walker_runs", "never_moves", "collision"]
SPACE = {"vehicles": 1, "walkers": 1, "weather": False}


def _campaign(scenario: dict[str, Any], **changes: Any) -> dict[str, Any]:
    return {
        "name": "own things",
        "tester": {"name": "own-climber"},
        "feedback": {"name": "walker_speed_mps", "direction": "maximise"},
        "agent": {"name": "parker"},
        "scenario": scenario,
        "space": SPACE,
        "budget": {"simulations": 3},
        "oracles": ORACLES,
        **changes,
    }


@pytest.mark.slow(seconds=20)
def test_results_outlive_the_packages_that_made_them(
    drivora: Drivora, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    site, laws = tmp_path / "site", tmp_path / "data" / "laws"
    install_parts(site, monkeypatch)
    laws.mkdir(parents=True)
    (laws / "own.yaml").write_text(LAW)
    scenario = {**SCENARIO, "max_sim_time": 1.0}
    scenario["ego_vehicles"] = [{**scenario["ego_vehicles"][0], "agent": {"name": "parker"}}]

    def write(name: str, content: Any) -> Path:
        path = tmp_path / name
        path.write_text(json.dumps(content))
        return path

    run_file = write("run.json", scenario)
    campaign_file = write("campaign.json", _campaign(scenario))
    study = _campaign(scenario)
    scenarios = [{"document": study.pop("scenario")}]
    study |= {"scenarios": scenarios, "agents": [study.pop("agent")], "repetitions": 2}
    study["methods"] = [study.pop("tester"), {"name": "random"}]
    study_file = write("study.json", study)
    suite = {"name": "own", "scenarios": [{"file": "run.json", "oracles": ORACLES}]}
    suite_file = write("suite.json", suite)

    valid = drivora("campaign", "validate", campaign_file)
    assert (valid.code, "own-climber" in valid.out) == (0, True), valid.err
    wrong = write("wrong.json", _campaign(scenario, feedback={"name": "walker_sped_mps"}))
    refused = drivora("campaign", "validate", wrong)
    assert refused.code == 2
    assert "/feedback/name: unknown objective 'walker_sped_mps'; did you mean" in refused.err
    assert "walker_speed_mps" in drivora("metrics", "list").out
    assert "greatest speed" in drivora("metrics", "show", "walker_speed_mps").out

    assert drivora("run", run_file).code == 0
    (run,) = drivora("runs", "list", "--json").json()
    shown = drivora("runs", "show", run["id"])
    assert "walker_speed_mps" in shown.out
    assert "walker_spare" in shown.out
    assert drivora("campaign", "run", campaign_file).code == 0
    (campaign,) = drivora("campaign", "list", "--json").json()
    assert drivora("study", "run", study_file).code == 0
    (made,) = drivora("study", "list", "--json").json()
    results = tmp_path / "results.json"
    assert drivora("suite", "run", suite_file, "--results", results).code == 0

    uninstall_parts(site)
    (laws / "own.yaml").unlink()
    assert drivora("runs", "list").code == 0
    # The unit of a metric is its package's to say; its value stays.
    again = drivora("runs", "show", run["id"]).out
    assert [line.replace("m/s", "").rstrip() for line in again.splitlines()] == [
        line.replace("m/s", "").rstrip() for line in shown.out.splitlines()
    ]
    report = drivora("campaign", "report", campaign["id"])
    assert report.code == 0
    assert "| coverage of the gene space | " in report.out
    assert "Coverage and times are not known" not in report.out
    assert (
        "| searched by, in place of its own objectives | maximise walker_speed_mps |" in report.out
    )
    for command in (
        ("campaign", "show", campaign["id"]),
        ("campaign", "show", campaign["id"], "--evaluation", "0"),
        ("campaign", "scenario", campaign["id"], "0"),
        ("study", "show", made["id"]),
        ("study", "compare", made["id"]),
        ("failures", "list"),
        ("suite", "history"),
        ("suite", "gate", suite_file, results),
        ("export", "--out", tmp_path / "tables"),
        ("study", "export", made["id"], "--out", tmp_path / "study-tables"),
    ):
        ended = drivora(*command)
        assert ended.code == 0, (command, ended.err)
    metrics = (tmp_path / "tables" / "metrics.csv").read_text()
    assert "metric,walker_speed_mps" in metrics
    assert "score,walker_spare" in metrics
    assert "objective,negated_walker_speed_mps" in metrics

    missing = "own-parts 0.1, not installed here: install it again"
    assert missing in " ".join(drivora("replay", run["id"]).out.split())
    assert missing in drivora("rejudge", tmp_path / "data").out
    assert drivora("campaign", "run", campaign_file).code == 2
