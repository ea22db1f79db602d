"""The one definition of a failure."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivora_service.oracles.verdict import Answer, Outcome, Severity, Verdict
from drivora_service.oracles.verdicts.accountability import Accountability, accountability
from drivora_service.oracles.verdicts.failure_definition import (
    COUNTED,
    DEFAULT_DEFINITION,
    Counted,
    DefinitionOrigin,
    FailureDefinition,
    KnownFailure,
    definition_from_json,
    definition_of_document,
    definition_to_json,
    requested_definition,
    state_definition,
)

COLLISION = Verdict(
    oracle="collision", ego="ego", outcome=Outcome.VIOLATED, message="", at_fault=True
)
OF_OTHERS = replace(COLLISION, at_fault=False, avoidable=Answer.NO)
PREVENTABLE = replace(OF_OTHERS, avoidable=Answer.YES)
UNAVOIDABLE = replace(COLLISION, avoidable=Answer.NO)
UNDETERMINED = replace(COLLISION, at_fault=None, undetermined=True)
SPEEDING = replace(COLLISION, oracle="speeding", at_fault=None)
NEAR_MISS = replace(COLLISION, oracle="near_miss", severity=Severity.OBSERVATION, at_fault=None)
MISSED = replace(SPEEDING, oracle="destination", follows="collision")

EVERY = (
    COLLISION, OF_OTHERS, PREVENTABLE, UNAVOIDABLE, UNDETERMINED, SPEEDING, NEAR_MISS, MISSED,
)  # fmt: skip

definitions = st.builds(
    FailureDefinition,
    counts=st.sampled_from(Counted),
    oracles=st.none() | st.sampled_from([("collision",), ("near_miss",), ("destination",)]),
    known=st.just(())
    | st.just((KnownFailure(oracle="collision", agents=("idm",), reason="issue 3"),)),
)
verdicts = st.lists(st.sampled_from(EVERY), max_size=6)


@pytest.mark.parametrize(
    ("counts", "failures"),
    [
        (Counted.ACCOUNTABLE, [COLLISION, SPEEDING]),
        (Counted.PREVENTABLE, [COLLISION, SPEEDING, PREVENTABLE]),
        (Counted.AT_FAULT, [COLLISION, SPEEDING, UNAVOIDABLE]),
        (Counted.POSSIBLY_AT_FAULT, [COLLISION, SPEEDING, UNAVOIDABLE, UNDETERMINED]),
        (
            Counted.ANY,
            [COLLISION, SPEEDING, UNAVOIDABLE, UNDETERMINED, PREVENTABLE, OF_OTHERS],
        ),
    ],
)
def test_what_each_word_counts(counts: Counted, failures: list[Verdict]) -> None:
    found = FailureDefinition(counts=counts).failures(EVERY)
    assert [one for one in EVERY if one in failures] == list(found)


def test_the_default_counts_what_an_ego_is_accountable_for() -> None:
    assert FailureDefinition(counts=Counted.ACCOUNTABLE, oracles=None) == DEFAULT_DEFINITION


def test_named_oracles_count_alone_observations_and_consequences_among_them() -> None:
    assert FailureDefinition(oracles=("near_miss",)).failures(EVERY) == (NEAR_MISS,)
    assert FailureDefinition(oracles=("destination",)).failures(EVERY) == (MISSED,)
    # Where its cause is looked at, that says whether it is a failure of the ego.
    both = FailureDefinition(oracles=("collision", "destination"))
    assert both.failures((OF_OTHERS, MISSED)) == ()


def test_a_missed_destination_of_an_earlier_version_follows_from_what_ended_the_drive() -> None:
    for reason, counts in (("collision", False), ("stuck", False), ("timeout", True)):
        old = replace(MISSED, follows="", evidence={"reason": reason})
        assert DEFAULT_DEFINITION.is_failure(old) == counts


def test_what_is_known_of_an_ads_does_not_count_where_it_drives() -> None:
    known = KnownFailure(oracle="collision", agents=("idm",), reason="issue 3")
    definition = FailureDefinition(known=(known,))
    assert not definition.is_failure(COLLISION, {"ego": "idm"})
    assert definition.is_failure(COLLISION, {"ego": "nmpc", "other": "idm"})
    # Before the egos were known, any of them may have been meant.
    assert not definition.is_failure(COLLISION, {"": "nmpc,idm"})


@given(definitions, verdicts)
def test_a_failure_is_a_violation_that_is_looked_at_and_of_a_counted_degree(
    definition: FailureDefinition, found: list[Verdict]
) -> None:
    for verdict in definition.failures(found, {"ego": "idm"}):
        assert definition.looks_at(verdict)
        assert accountability(verdict) in COUNTED[definition.counts]
    strongest = definition.strongest(found)
    looked_at = [accountability(one) for one in found if definition.looks_at(one)]
    assert strongest in looked_at or (strongest is None and not looked_at)


@given(definitions, verdicts)
def test_more_words_never_count_less(definition: FailureDefinition, found: list[Verdict]) -> None:
    for less, more in (
        (Counted.ACCOUNTABLE, Counted.PREVENTABLE),
        (Counted.ACCOUNTABLE, Counted.AT_FAULT),
        (Counted.AT_FAULT, Counted.POSSIBLY_AT_FAULT),
        (Counted.POSSIBLY_AT_FAULT, Counted.ANY),
        (Counted.PREVENTABLE, Counted.ANY),
    ):
        few = replace(definition, counts=less).failures(found)
        many = replace(definition, counts=more).failures(found)
        assert set(map(id, few)) <= set(map(id, many))


def test_every_degree_counts_for_some_word() -> None:
    assert COUNTED[Counted.ANY] == frozenset(Accountability)
    assert set(COUNTED) == set(Counted)


@given(definitions)
def test_a_definition_is_read_back_as_it_was_stored(definition: FailureDefinition) -> None:
    assert definition_from_json(definition_to_json(definition)) == definition


def test_the_default_takes_no_room() -> None:
    assert definition_to_json(DEFAULT_DEFINITION) == ""


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("{}", DEFAULT_DEFINITION),
        (
            '{"counts": "any", "oracles": ["off_road", "collision"]}',
            FailureDefinition(counts=Counted.ANY, oracles=("collision", "off_road")),
        ),
    ],
)
def test_a_campaign_says_what_it_counts(text: str, expected: FailureDefinition) -> None:
    assert definition_of_document(text) == expected


def test_a_request_that_asks_for_nothing_leaves_what_was_defined() -> None:
    assert requested_definition(None, ()) is None
    assert requested_definition(None, ["b", "a", "b"]) == FailureDefinition(oracles=("a", "b"))
    assert requested_definition(Counted.ANY, ()) == FailureDefinition(counts=Counted.ANY)


def test_a_definition_is_stated_with_who_defined_it() -> None:
    ours = FailureDefinition(counts=Counted.ANY)
    cases: list[tuple[Any, Any, DefinitionOrigin, Counted | None]] = [
        ((), None, DefinitionOrigin.DEFAULT, Counted.ACCOUNTABLE),
        ((DEFAULT_DEFINITION,), None, DefinitionOrigin.DEFAULT, Counted.ACCOUNTABLE),
        ((ours, ours), None, DefinitionOrigin.POSTED, Counted.ANY),
        ((ours,), DefinitionOrigin.REQUEST, DefinitionOrigin.REQUEST, Counted.ANY),
        ((ours, DEFAULT_DEFINITION), None, DefinitionOrigin.POSTED, None),
    ]
    for given_definitions, origin, stated, counts in cases:
        found = state_definition(given_definitions, origin)
        assert (found.origin, found.counts) == (stated, counts)
    assert str(ours) in state_definition((ours, DEFAULT_DEFINITION)).words
    many = [FailureDefinition(oracles=(f"law_{number}",)) for number in range(5)]
    assert state_definition(many).words.endswith("or 2 more")
