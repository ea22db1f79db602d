from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.cli.conftest import Drivora


@pytest.mark.slow
def test_an_agent_gets_a_card_and_an_absent_one_its_reason(
    drivora: Drivora, tmp_path: Path
) -> None:
    out = tmp_path / "cards"
    ended = drivora(
        "agents", "benchmark", "sumo-idm", "fop", "sumo-idm", "--runs", "1", "--out", out,
        "--workers", "1", "--json",
    )  # fmt: skip
    assert ended.code == 0, ended.err
    told = ended.json()
    (card,) = told["cards"]
    assert (card["agent"], card["privileged"]) == ("sumo-idm", True)
    assert set(card["networks"]) == {"tee-town", "signal-grid", "roundabout"}
    assert card["total"]["runs"] == card["total"]["judged"] == 3
    assert card["total"]["arrivals"] == 3
    assert card["total"]["driving_score"] > 50.0
    assert card["total"]["step_cost_median_us"] > 0.0
    assert card["total"]["agent_cost_median_us"] is None
    assert len({run["trace_sha256"] for run in card["runs"]}) == 3
    assert told["absent"] == [
        {"agent": "fop", "reason": "run `drivora agents install fop`"},
    ]
    assert {path.name for path in out.iterdir()} == {
        "cards.md", "cards.json", "sumo-idm.md", "sumo-idm.png",
    }  # fmt: skip
    assert json.loads((out / "cards.json").read_text()) == told
    assert "sumo-idm" in ended.err


def test_only_absent_agents_are_no_failure(drivora: Drivora) -> None:
    ended = drivora("agents", "benchmark", "fop")
    assert ended.code == 0, ended.err
    assert "fop was not run: run `drivora agents install fop`" in ended.out


def test_an_unknown_agent_is_wrong_use(drivora: Drivora) -> None:
    ended = drivora("agents", "benchmark", "idn")
    assert ended.code == 2
    assert "idn" in ended.err
