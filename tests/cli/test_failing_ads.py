"""An ADS that raises in every run fails a gate."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from tests.cli.conftest import Drivora

pytestmark = pytest.mark.usefixtures("site")

SHORT = {**SCENARIO, "max_sim_time": 2.0}
CAMPAIGN = {
    "name": "raising",
    "tester": {"name": "random"},
    "agent": {"name": "failing"},
    "scenario": {"file": "crossing.json"},
    "counts": "at_fault",
    "budget": {"simulations": 2},
    "workers": 1,
}
ACCOUNTABLE = "Failures are violations that an ego is accountable for (accountable), of all oracles"


@pytest.fixture
def scenario(tmp_path: Path) -> Path:
    path = tmp_path / "crossing.json"
    path.write_text(json.dumps(SHORT))
    return path


def test_the_gate_of_runs_counts_those_in_which_the_ads_raised(
    drivora: Drivora, scenario: Path
) -> None:
    ended = drivora("run", scenario, "--agent", "failing", "--gate", "--workers", "1")
    assert ended.code == 1
    assert "agent_raised" in ended.out
    assert ended.err.splitlines()[-3:-1] == [
        "gate failed: 1 failing run, 0 violations (agent_failed in 1)",
        "the ADS failed in crossing",
    ]
    assert ended.err.splitlines()[-1].startswith(ACCOUNTABLE)
    named = ("--gate-oracle", "collision=5", "--workers", "1")
    assert drivora("run", scenario, "--agent", "failing", *named).code == 1
    assert drivora("run", scenario, "--agent", "failing", "--workers", "1").code == 3


def test_a_gate_does_not_decide_where_runs_say_nothing_of_the_ads(
    drivora: Drivora, scenario: Path, tmp_path: Path
) -> None:
    lost = tmp_path / "lost.json"
    lost.write_text(json.dumps({**SHORT, "map_region": {"town": "Town99"}}))
    files = (scenario, lost)
    ended = drivora("run", *files, "--agent", "failing", "--gate", "--workers", "1")
    assert ended.code == 3
    assert "gate" not in ended.err


@pytest.mark.slow
def test_the_gate_of_a_campaign_counts_simulations_in_which_the_ads_raised(
    drivora: Drivora, scenario: Path, tmp_path: Path
) -> None:
    file = tmp_path / "campaign.json"
    file.write_text(json.dumps(CAMPAIGN))
    ended = drivora("campaign", "run", file, "--gate")
    assert ended.code == 1
    words = "Failures are violations that an ego is accountable for, or at fault without a way out"
    assert "2 runs without a result: " in ended.out
    assert words in ended.out
    (listed,) = drivora("campaign", "list", "--json").json()
    said, named, defined = ended.err.splitlines()[-3:]
    assert said == "gate failed: 2 failing runs, 0 violations (agent_failed in 2)"
    assert named == f"the ADS failed in {listed['id']}-0, {listed['id']}-1"
    assert defined.startswith(words)
    assert drivora("runs", "show", f"{listed['id']}-0", "--json").json()["cause"] == "agent_raised"

    # The list shows which campaigns count something else.
    other = {**CAMPAIGN, "name": "other", "oracles": ["collision"]}
    del other["counts"]
    file.write_text(json.dumps(other))
    ungated = drivora("campaign", "run", file)
    assert ungated.code == 3
    assert "nothing was judged: 2 runs without a result: " in ungated.err
    assert "repair the ADS, and run the campaign again" in ungated.err
    header, newer, older = (
        line for line in drivora("campaign", "list").out.splitlines() if "  " in line.strip()
    )
    assert header.split()[-1] == "counts"
    assert newer.rstrip().endswith("accountable, 1 oracle")
    assert older.rstrip().endswith("at_fault")


@pytest.mark.parametrize(
    ("command", "said", "unsaid"),
    [
        ("run", "[default: accountable]", "as defined where the runs were posted"),
        ("run", "a violation that --counts counts", "in a way that an ego is accountable for"),
        ("campaign run", "the campaign's counts and oracles", "that an ego is accountable for"),
    ],
)
def test_help_names_the_definition_that_a_gate_obeys(
    drivora: Drivora, command: str, said: str, unsaid: str
) -> None:
    printed = drivora(*command.split(), "--help", COLUMNS="200").out
    words = " ".join(printed.replace("│", " ").split())
    assert said in words
    assert "a failure of the ADS itself always does" in words
    assert unsaid not in words
