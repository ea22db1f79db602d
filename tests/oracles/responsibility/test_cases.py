"""The shipped cases of responsibility get the verdicts that were written down before the rule."""

from __future__ import annotations

import json

import pytest

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.oracles.verdict import Outcome
from drivora_service.scenario.documents import parse_document
from drivora_service.scenario.validation import validate_document
from tests.oracles.responsibility.case import AT_FAULT, NOT_AT_FAULT, UNDETERMINED, Case
from tests.oracles.responsibility.families import all_cases
from tests.oracles.responsibility.judged import collisions, fault
from tests.oracles.responsibility.writing import FOLDER, PAGE, TABLE, page_text, table_text

CASES = all_cases()
WRONG_TODAY = frozenset(
    {
        "both-change-into-the-middle-lane",
        "both-drift-over-the-line",
        "both-drive-through-all-way-stop",
        "both-reach-over-the-line",
        "both-run-red",
        "ego-begins-too-near",
        "ego-creeps-out-and-stops-before-priority-traffic",
        "ego-cuts-in-and-brakes",
        "ego-cuts-in-and-stops",
        "ego-cuts-in-short",
        "ego-emerges-before-priority-traffic",
        "ego-enters-roundabout-before-circulating-vehicle",
        "ego-evades-wrong-way-driver-who-returns",
        "ego-from-the-left-of-a-vehicle",
        "ego-has-stood-in-oncoming-lane",
        "ego-hits-vehicle-that-dashes-from-the-verge",
        "ego-off-the-road-is-driven-into",
        "ego-on-the-wrong-side-meets-another-ego",
        "ego-runs-red-and-is-hit",
        "ego-stands-half-in-oncoming-lane",
        "ego-stops-in-oncoming-lane",
        "ego-straddles-two-lanes-in-signalised-junction",
        "ego-swings-out-into-overtaker",
        "ego-turns-left-before-oncoming",
        "ego-turns-left-on-green-before-oncoming",
        "ego-veers-into-oncoming-in-junction",
        "head-on-with-driver-who-comes-over",
        "head-on-with-slow-wrong-way-driver",
        "head-on-with-wrong-way-driver",
        "obstacle-falls-before-ego",
        "oncoming-overtaker-meets-ego",
        "oncoming-turns-left-before-ego",
        "oncoming-turns-left-on-green-before-ego",
        "oncoming-veers-head-on-in-junction",
        "oncoming-vehicle-reaches-over-the-line",
        "other-cuts-in-short",
        "other-cuts-in-short-from-the-right",
        "other-runs-red-before-ego",
        "other-turns-round-before-ego",
        "vehicle-creeps-out-and-stops-before-ego",
        "vehicle-emerges-before-ego",
        "vehicle-enters-roundabout-before-ego",
        "walker-on-red-late",
        "walker-runs-onto-crossing",
        "walker-steps-out",
        "wrong-way-driver-comes-through-junction",
        "wrong-way-driver-stops-short-before-ego",
        "wrong-way-driver-swerves-into-egos-side",
    }
)
"""Cases that the rule gets wrong."""

each_case = pytest.mark.parametrize(
    "case",
    [
        pytest.param(
            case,
            id=case.name,
            marks=[pytest.mark.xfail(strict=True)] if case.name in WRONG_TODAY else [],
        )
        for case in CASES
    ],
)


@each_case
def test_the_expected_verdict(case: Case) -> None:
    expected = {case.egos[0].name: case.expected, **case.expected_of}
    verdicts = collisions(case.name)
    assert {ego: fault(verdict) for ego, verdict in verdicts.items()} == expected
    for verdict in verdicts.values():
        assert verdict.outcome is Outcome.VIOLATED
        assert verdict.evidence["reason"]


def test_there_are_enough_cases_of_every_answer() -> None:
    answers = [case.expected for case in CASES]
    assert len(CASES) >= 60
    assert len({case.name for case in CASES}) == len(CASES)
    assert min(answers.count(AT_FAULT), answers.count(NOT_AT_FAULT)) >= 25
    assert answers.count(UNDETERMINED) >= 6


def test_the_documents_are_shipped() -> None:
    agents, networks = AgentCatalogue().availability(), NetworkCatalogue(shipped_networks())
    for case in CASES:
        text = (FOLDER / f"{case.name}.json").read_text()
        assert text == case.text()
        validate_document(parse_document(text), networks, agents)
    assert len(list(FOLDER.glob("*.json"))) == len(CASES) + 1


def test_the_table_and_its_page_are_current() -> None:
    text = TABLE.read_text()
    entries = json.loads(text)["cases"]
    assert table_text(entries) == text
    assert PAGE.read_text() == page_text(entries)
    shown = {entry["name"]: (entry["happens"], entry["source"]) for entry in entries}
    assert shown == {case.name: (case.happens, case.source) for case in CASES}
    for entry, case in zip(entries, CASES, strict=True):
        assert entry["expected"] == {case.egos[0].name: case.expected, **case.expected_of}
