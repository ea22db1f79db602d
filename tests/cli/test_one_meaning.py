"""Gate, comparison, lists of failures, campaign and minimiser count the same runs alike."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
import yaml

from tests.cli.conftest import Drivora

# Each test performs dozens of runs.
pytestmark = pytest.mark.slow

SLOW = ("--agent-parameter", "reaction_time=1.0")
EXAMPLES = Path(__file__).parents[2] / "openscenario_schemas" / "examples" / "campaigns"


def batches(drivora: Drivora) -> list[dict[str, Any]]:
    """The batches of the data folder, the first one first."""
    runs = drivora("runs", "list", "--limit", "10000", "--json").json()
    found: dict[str, list[dict[str, Any]]] = {}
    for run in reversed(runs):
        found.setdefault(run["batch_id"], []).append(run)
    return [{"id": batch_id, "runs": of} for batch_id, of in found.items()]


def failing(drivora: Drivora, batch: str, *options: str) -> set[str]:
    """The runs of a batch with a failure, as the lists of failures have them."""
    arguments = ("failures", "list", "--batch", batch, "--limit", "10000", "--json", *options)
    return {one["run_id"] for one in drivora(*arguments).json()}


def test_two_batches_of_a_suite_have_one_number_of_failures(
    drivora: Drivora, tmp_path: Path
) -> None:
    suite = ("suite", "run", "smoke", "--select", "near-miss", "--agent", "idm")
    results, baseline = tmp_path / "a.json", tmp_path / "baseline.json"
    drivora(*suite, "--results", results)
    assert drivora("suite", "baseline", "smoke", results, "--baseline", baseline).code == 0
    gate = drivora(*suite, *SLOW, "--baseline", baseline, "--json").json()
    a, b, *_ = batches(drivora)
    before, now = gate["overall"]["runs_before"], gate["overall"]["runs"]
    assert now > before, "the slower version fails more often"

    compared = drivora("compare", a["id"], b["id"], "--json").json()
    assert compared["definition"]["counts"] == "any", "as the shipped suite says"
    assert compared["definition"]["origin"] == "posted"
    for batch, side, number in ((a, "runs_a", before), (b, "runs_b", now)):
        assert compared["failures"][side] == number
        assert failing(drivora, batch["id"]) == {
            run["id"] for run in batch["runs"] if run["failures"]
        }
        assert len(failing(drivora, batch["id"])) == number

    # Switched, they agree as well.
    fewer = drivora("compare", a["id"], b["id"], "--counts", "accountable", "--json").json()
    assert fewer["definition"]["origin"] == "request"
    for batch, side in ((a, "runs_a"), (b, "runs_b")):
        accountable = failing(drivora, batch["id"], "--counts", "accountable")
        assert fewer["failures"][side] == len(accountable)
        assert accountable < failing(drivora, batch["id"])


def test_a_suite_of_a_campaign_fails_for_what_the_campaign_counted(
    drivora: Drivora, tmp_path: Path
) -> None:
    content = yaml.safe_load((EXAMPLES / "late-braking.yaml").read_text())
    content["scenario"] = json.loads((EXAMPLES / content["scenario"]["file"]).read_text())
    content |= {"budget": {"simulations": 40}, "tester": {"name": "random"}, "seed": 3}
    content |= {"counts": "any"}
    file = tmp_path / "campaign.json"
    file.write_text(json.dumps(content))
    campaign = drivora("campaign", "run", file, "--json").json()
    found = {one["evaluation"] for one in campaign["failures"]}
    assert len(found) == campaign["counts"]["violating"] > 2
    assert {one["verdict"]["oracle"] for one in campaign["failures"]} == {"collision"}

    folder = tmp_path / "suite"
    export = ("campaign", "export", campaign["id"], "--suite", folder, "--each", "failure")
    added = drivora(*export, "--json").json()["added"]
    flaky = {f["evaluation"] for f in campaign["failures"] if f["confirmation"] == "flaky"}
    assert len(added) == len(found - flaky)
    told = drivora("suite", "run", folder, "--json").json()
    assert {one["scenario"] for one in told["failures"]} == {Path(one).stem for one in added}
    assert {one["oracle"] for one in told["failures"]} == {"collision"}
    (batch,) = (one for one in batches(drivora) if len(one["runs"]) == len(added))
    assert len(failing(drivora, batch["id"])) == len(added)

    # Other violations of these runs are graver or not, and none is followed.
    number = min(found - flaky)
    small = drivora("minimize", f"{campaign['id']}-{number}", "--budget", "5", "--json").json()
    assert small["failure"]["oracle"] == "collision"
