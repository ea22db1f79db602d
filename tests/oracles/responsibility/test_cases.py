"""The shipped cases of responsibility get the verdicts that were written down before the rule."""

from __future__ import annotations

import json

import pytest

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.oracles.verdict import Outcome
from drivora_service.oracles.verdicts.artefact_verdicts import ARTEFACT
from drivora_service.scenario.documents import parse_document
from drivora_service.scenario.validation import validate_document
from tests.oracles.responsibility.case import AT_FAULT, NOT_AT_FAULT, UNDETERMINED, Case
from tests.oracles.responsibility.families import all_cases
from tests.oracles.responsibility.judged import collisions, fault
from tests.oracles.responsibility.writing import (
    FOLDER,
    PAGE,
    PICTURED,
    PICTURES,
    TABLE,
    nuplan,
    page_text,
    table_text,
)

CASES = all_cases()
each_case = pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)


@each_case
def test_the_expected_verdict(case: Case) -> None:
    expected = {case.egos[0].name: case.expected, **case.expected_of}
    verdicts = collisions(case.name)
    assert {ego: fault(verdict) for ego, verdict in verdicts.items()} == expected
    for verdict in verdicts.values():
        # What the simulator did is no violation.
        made = ARTEFACT in verdict.evidence
        assert verdict.outcome is (Outcome.NOT_MEASURABLE if made else Outcome.VIOLATED)
        assert made == (verdict.evidence["rule"] == "appeared")
        assert verdict.evidence["reason"]


def test_there_are_enough_cases_of_every_answer() -> None:
    answers = [case.expected for case in CASES]
    assert len(CASES) >= 250
    assert len({case.name for case in CASES}) == len(CASES)
    assert min(answers.count(AT_FAULT), answers.count(NOT_AT_FAULT)) >= 100
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
        assert entry["nuplan"] == {ego: nuplan(case, ego) for ego in entry["expected"]}


def test_ten_cases_are_pictured() -> None:
    assert len(set(PICTURED)) == 10
    assert {path.stem for path in PICTURES.glob("*.png")} == set(PICTURED)
    assert set(PICTURED) <= {case.name for case in CASES}
