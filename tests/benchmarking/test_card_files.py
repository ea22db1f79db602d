from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

from drivora_service.benchmarking.card import card_of
from drivora_service.benchmarking.card_files import write_cards
from drivora_service.benchmarking.card_text import card_markdown
from drivora_service.runs.run_report import RunStatus
from tests.benchmarking.made_up_runs import AGENT, failed, finished, violation

ABSENT = replace(AGENT, name="far-away", installed=False, reason="run `drivora agents install x`")
HIT = violation("collision", at_fault=True, message="hit | npc_1\nwith its front")


def test_cards_are_written_as_a_table_pages_and_data(tmp_path: Path) -> None:
    card = card_of(AGENT, (finished(1, HIT, score=40.0), finished(2)))
    picture = tmp_path / "made-up.svg"
    written = write_cards([card], [ABSENT], tmp_path, runs=2, pictures={"made-up": picture})
    assert {path.name for path in written} == {"cards.md", "cards.json", "made-up.md"}
    table = (tmp_path / "cards.md").read_text()
    assert (
        "| [`made-up`](made-up.md) | privileged | 2 | 2 | 1 | 1 | 1 | 0 | 0 | 70.0 | 1.00 | 0.10 "
        "| 0.10 | 0.04 | 0 |" in table
    )
    assert "- `far-away`: run `drivora agents install x`" in table
    content = json.loads((tmp_path / "cards.json").read_text())
    assert content["absent"] == [{"agent": "far-away", "reason": ABSENT.reason}]
    (told,) = content["cards"]
    assert told["privileged"] is True
    assert told["total"]["clean_arrivals"] == 1
    assert [run["violated"] for run in told["runs"]] == [["collision"], []]
    page = (tmp_path / "made-up.md").read_text()
    assert "![made-up on tee-town-01](made-up.svg)" in page
    assert "Licence: none stated" in page


def test_a_page_has_the_scores_of_benchmarks() -> None:
    runs = [finished(n, score=score, comfort=0.5) for n, score in ((1, 100.0), (2, 40.0))]
    page = card_markdown(card_of(AGENT, runs), runs=2)
    # The deviation of 100 and 40 is the root of 2 · 30² over 1.
    assert "driving score 70.0 with a standard deviation of 42.4 (2.1), - (2.0), - (1.0)" in page
    assert "success rate -, efficiency -, comfort 0.50" in page
    assert "- nuPlan: closed-loop score -, with a computed free drive" in page


def test_what_programs_said_stays_in_its_cell() -> None:
    page = card_markdown(card_of(AGENT, (finished(1, HIT),)), runs=1)
    assert "| collision | 1 | 1 | tee-town-01: hit \\| npc_1 with its front |" in page


def test_an_agent_that_always_fails_says_with_what_cause() -> None:
    card = card_of(AGENT, [failed(n, RunStatus.AGENT_FAILED, "agent_hung") for n in (1, 2)])
    page = card_markdown(card, runs=2)
    assert "| agent failed | agent_hung | 2 | tee-town-01: it was agent_hung |" in page
    assert "| all | 2 | 0 | - | - | - | - | - | 0.0 | - | - | - | - | 2 |" in page
    assert "## A run" not in page


def test_an_agent_without_fault_is_said_to_have_none() -> None:
    page = card_markdown(card_of(AGENT, (finished(1),)), runs=1, picture="made-up.svg")
    assert "It violated no oracle in any judged run." in page
    assert "The longest run, tee-town-01; no oracle was violated in it." in page


def test_the_shown_run_is_told_once_an_oracle() -> None:
    again = violation("collision", at_fault=False, message="hit npc_2")
    run = finished(1, HIT, violation("red_light", message="Ran a light."), again)
    page = card_markdown(card_of(AGENT, (run,)), runs=1, picture="made-up.svg")
    assert "tee-town-01: hit \\| npc_1 with its front Ran a light.\n" in page
    assert "npc_2" not in page
