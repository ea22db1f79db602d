"""The same failure: what must be equal, what may differ, and which violation is followed."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivora_service.oracles.verdict import Answer, Outcome, Severity, Verdict
from drivora_service.oracles.verdicts.accountability import Accountability
from drivora_service.oracles.verdicts.failure_definition import Counted, FailureDefinition
from drivora_service.oracles.verdicts.failure_identity import gravest, identity_of

COLLISION = Verdict(
    oracle="collision",
    ego="ego",
    outcome=Outcome.VIOLATED,
    message="Collided with walker_1.",
    at_fault=True,
    avoidable=Answer.YES,
    time=4.55,
    location=(4.5, 47.0),
    counterpart="walker_1",
    evidence={"counterpart_role": "npc_walker", "face": "front"},
)


def test_an_identity_tells_what_must_come_again() -> None:
    identity = identity_of(COLLISION, radius_m=5.0)
    assert (identity.oracle, identity.ego) == ("collision", "ego")
    assert identity.accountability is Accountability.AVOIDABLE
    assert identity.counterpart_role == "npc_walker"
    assert identity.location == (4.5, 47.0)
    assert identity.radius_m == 5.0


@pytest.mark.parametrize(
    "other",
    [
        replace(COLLISION, oracle="near_miss"),
        replace(COLLISION, ego="ego_2"),
        replace(COLLISION, outcome=Outcome.PASSED),
        replace(COLLISION, outcome=Outcome.NOT_MEASURABLE),
        replace(COLLISION, at_fault=False),
        replace(COLLISION, at_fault=None, undetermined=True),
        replace(COLLISION, at_fault=None),
        replace(COLLISION, avoidable=Answer.NO),
        replace(COLLISION, avoidable=Answer.NOT_MEASURABLE),
        replace(COLLISION, evidence={"counterpart_role": "npc_vehicle"}),
        replace(COLLISION, evidence={}),
        replace(COLLISION, location=(14.6, 47.0)),
        replace(COLLISION, location=None),
    ],
)
def test_another_failure(other: Verdict) -> None:
    identity = identity_of(COLLISION)
    assert identity.is_of(COLLISION)
    assert not identity.is_of(other)
    assert identity.find_in([other]) is None


@pytest.mark.parametrize(
    "other",
    [
        replace(COLLISION, time=0.5, step=10),
        replace(COLLISION, counterpart="walker_7"),
        replace(COLLISION, evidence={"counterpart_role": "npc_walker", "face": "side"}),
        replace(COLLISION, location=(14.4, 47.0)),
        replace(COLLISION, physically_avoidable=Answer.NO),
    ],
)
def test_the_same_failure(other: Verdict) -> None:
    assert identity_of(COLLISION).is_of(other)


def test_a_failure_without_a_place_is_the_same_without_a_place() -> None:
    nowhere = replace(COLLISION, location=None)
    assert identity_of(nowhere).is_of(nowhere)
    assert not identity_of(nowhere).is_of(COLLISION)


def test_the_earliest_of_several_is_found() -> None:
    later, earlier = replace(COLLISION, time=9.0), replace(COLLISION, time=2.0)
    assert identity_of(COLLISION).find_in([later, earlier, replace(earlier, ego="x")]) is earlier


ANY = FailureDefinition(counts=Counted.ANY)


def test_what_is_gravest() -> None:
    """Fault first, then severity, collisions, avoidability, and time."""
    ranked = [
        replace(COLLISION, severity=Severity.CRITICAL, avoidable=Answer.NO),
        replace(COLLISION, time=3.0),
        replace(COLLISION, time=4.0),
        replace(COLLISION, time=1.0, avoidable=Answer.NO),
        replace(COLLISION, oracle="red_light", time=0.1, avoidable=None),
        replace(COLLISION, oracle="speeding", severity=Severity.MINOR),
        replace(COLLISION, severity=Severity.CRITICAL, at_fault=None, undetermined=True),
        replace(COLLISION, severity=Severity.CRITICAL, at_fault=False),
    ]
    passed = replace(COLLISION, outcome=Outcome.PASSED)
    observed = replace(COLLISION, oracle="near_miss", severity=Severity.OBSERVATION)
    for begin, expected in enumerate(ranked):
        assert gravest([passed, observed, *reversed(ranked[begin:])], ANY) is expected
    assert gravest([passed, observed], ANY) is None
    assert gravest([*ranked, observed], ANY, oracle="near_miss") is observed
    assert gravest(ranked, ANY, oracle="speeding") is ranked[5]
    assert gravest(ranked, ANY, oracle="blocked") is None
    only = FailureDefinition(oracles=("red_light",))
    assert gravest(ranked, only) is ranked[4]
    assert gravest(ranked[6:], FailureDefinition()) is None


@given(st.permutations([1.0, 2.0, 3.0, 4.0]))
def test_the_order_of_verdicts_does_not_matter(times: list[float]) -> None:
    found = gravest([replace(COLLISION, time=time) for time in times], ANY)
    assert found is not None
    assert found.time == 1.0
