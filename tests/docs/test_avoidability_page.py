"""The page about avoidability says what the results say."""

from __future__ import annotations

import json
import re
from collections import Counter
from pathlib import Path
from typing import Any

import pytest


@pytest.fixture(scope="module")
def lines(repository: Path) -> list[dict[str, Any]]:
    text = (repository / "benchmarks" / "results" / "avoidability.jsonl").read_text()
    return [json.loads(line) for line in text.splitlines()]


@pytest.fixture(scope="module")
def page(repository: Path) -> str:
    return (repository / "docs" / "explanation" / "avoidability.md").read_text()


def test_the_table_is_that_of_the_results(lines: list[dict[str, Any]], page: str) -> None:
    rows = re.findall(r"^\| ([\w-]+(?:, [\w ]+)?) ((?:\| \d+ )+)\|$", page, re.MULTILINE)
    written = {name: [int(n) for n in re.findall(r"\d+", cells)] for name, cells in rows}
    counted = {}
    for name in {*(line["part"] for line in lines), "together"}:
        here = [line for line in lines if name in (line["part"], "together")]
        answers = Counter(line["avoidable"] for line in here)
        full = sum(line["physically_avoidable"] == "yes" for line in here)
        told = [answers[answer] for answer in ("yes", "no", "not_measurable")]
        preventable = sum(line["avoidable"] == "yes" and line["at_fault"] is False for line in here)
        counted[name] = [len(here), *told, preventable, full]
    assert written == counted


def test_it_tells_how_many_are_at_fault(lines: list[dict[str, Any]], page: str) -> None:
    fault = [line for line in lines if line["at_fault"]]
    avoidable = sum(line["avoidable"] == "yes" for line in fault)
    assert f"{len(fault)} of the 100 are the ego's fault, {avoidable} of these avoidable" in page


def test_there_are_a_hundred_different_collisions(lines: list[dict[str, Any]]) -> None:
    assert len({(line["trace_sha256"], line["counterpart"]) for line in lines}) == 100
    assert len({line["agent"] for line in lines}) == 3


def test_the_ten_stand_under_their_answers(lines: list[dict[str, Any]], page: str) -> None:
    answers = {Path(line["trace"]).stem: line["avoidable"] for line in lines}
    _, avoidable, others = re.split(r"\*\*(?:Avoidable|Not avoidable)\*\*", page)
    for text, answer in ((avoidable, "yes"), (others, "no")):
        names = re.findall(r"images/avoidability/([\w-]+)\.png", text)
        assert {answers[name] for name in names} == {answer}
    assert len(re.findall(r"images/avoidability/", page)) == 10


def test_no_collision_counts_as_avoidable_that_showed_too_late(
    lines: list[dict[str, Any]],
) -> None:
    for line in lines:
        found = line["evidence"]["avoidability"]
        in_time = (
            found["latest_before"] is not None
            and found["risk_perceived_before"] is not None
            and found["latest_before"] <= found["risk_perceived_before"]
        )
        assert (line["avoidable"] == "yes") == (in_time or found["own_breach"] is not None)
