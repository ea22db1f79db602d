"""Groups and sentences of failures: of the facts in the verdict, and no others."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from drivora_service.oracles.verdict import Answer, Outcome, Verdict
from drivora_service.oracles.verdicts.failure_facts import (
    avoidability_words,
    avoidable_until,
    explain_collision,
    failure_group,
    failure_sentence,
    full_message,
    manoeuvre,
)

EVIDENCE: dict[str, Any] = {
    "avoidability": {"latest_before": 2.05},
    "counterpart_role": "npc_walker",
    "reason": "the other went across the lane, and there was time to brake",
    "rule": "pedestrian",
    "face": "front",
    "ego_speed": 7.96,
    "relative_speed": 8.93,
}
COLLISION = Verdict(
    oracle="collision",
    ego="ego",
    outcome=Outcome.VIOLATED,
    message="Collided with walker_1 at 8.9 m/s: the other went across the lane.",
    at_fault=True,
    avoidable=Answer.YES,
    time=4.55,
    location=(4.52, 46.96),
    counterpart="walker_1",
    evidence=EVIDENCE,
)


def test_a_collision_is_told_by_party_speed_manoeuvre_place_and_time() -> None:
    told = failure_sentence(
        COLLISION, town="tee-town", kind="collision|junction C|npc_walker, front"
    )
    assert told == (
        "Collided with a walker at 8.9 m/s relative to it (front of the ego): the other went "
        "across the lane, and there was time to brake, at junction C of tee-town; the fault of the "
        "ego, avoidable until 2.50 s."
    )
    speed = f"at {EVIDENCE['relative_speed']:.1f} m/s"
    assert speed in told, "one failure has one speed, in its sentence and in its message"
    assert speed in COLLISION.message


@pytest.mark.parametrize(
    ("changes", "ending"),
    [
        ({"avoidable": Answer.NO}, "; the fault of the ego, not avoidable once the danger showed."),
        ({"avoidable": None}, "; the fault of the ego."),
        (
            {"avoidable": Answer.NOT_MEASURABLE},
            "; the fault of the ego; whether it was avoidable is not measurable.",
        ),
        ({"at_fault": False}, "; not the fault of the ego, but avoidable until 2.50 s."),
        ({"at_fault": None, "undetermined": True}, "; fault undetermined, avoidable until 2.50 s."),
        ({"at_fault": None}, "at (4.5 m, 47.0 m) of grid; avoidable until 2.50 s."),
    ],
)
def test_the_fault_is_told_as_far_as_it_is_known(changes: dict[str, Any], ending: str) -> None:
    told = failure_sentence(replace(COLLISION, **changes), town="grid")
    assert told.endswith(ending)
    assert ("avoidable until" in told) == (
        avoidable_until(replace(COLLISION, **changes)) is not None
    )


def test_other_violations_are_told_in_the_words_of_the_oracle() -> None:
    verdict = Verdict(
        oracle="red_light",
        ego="ego",
        outcome=Outcome.VIOLATED,
        message="Crossed the stop line at 5.0 m/s.",
        at_fault=True,
        evidence={"front_crossed_on": "yellow"},
    )
    assert failure_sentence(verdict, town="grid", kind="red_light|road A") == (
        "Crossed the stop line at 5.0 m/s, on road A of grid; the fault of the ego."
    )
    assert failure_group(verdict) == "red_light|yellow"


def test_groups_are_the_same_everywhere() -> None:
    assert failure_group(COLLISION) == "collision|npc_walker, front|pedestrian"
    elsewhere = replace(COLLISION, location=(0.0, 0.0), time=1.0, at_fault=False)
    assert failure_group(elsewhere) == failure_group(COLLISION)
    other = replace(COLLISION, evidence={**EVIDENCE, "rule": "too_near"})
    assert failure_group(other) != failure_group(COLLISION)
    assert failure_group(replace(COLLISION, oracle="deadlock", evidence={"cycle": ["a", "b"]})) == (
        "deadlock|cycle of 2"
    )
    assert failure_group(replace(COLLISION, evidence={})) == "collision"


def test_the_manoeuvre_of_a_late_arrival_is_its_reason() -> None:
    assert manoeuvre({"reason": "late"}) == "late"
    assert manoeuvre({}) == ""


@pytest.mark.parametrize(
    "evidence",
    [
        {},
        {"avoidability": {"not_measurable": "no grip"}},
        {"avoidability": {"latest_before": None}},
    ],
)
def test_without_a_last_moment_none_is_told(evidence: dict[str, Any]) -> None:
    verdict = replace(COLLISION, evidence={**EVIDENCE, "avoidability": {}, **evidence})
    assert avoidable_until(verdict) is None
    assert "avoidable until" not in failure_sentence(verdict, town="grid")


@pytest.mark.parametrize(
    ("avoidable", "assessed", "words"),
    [
        (Answer.YES, {"latest_before": 2.05}, "avoidable until 2.50 s"),
        (Answer.YES, {"latest_before": None}, "avoidable"),
        (
            Answer.NO,
            {"risk_perceived_before": 0.6},
            "not avoidable: the danger showed 0.6 s before",
        ),
        (Answer.NO, {"risk_perceived_before": None}, "not avoidable"),
        (
            Answer.NOT_MEASURABLE,
            {"not_measurable": "the trace does not record the grip of the road"},
            "not measurable whether avoidable: the trace does not record the grip of the road",
        ),
        (None, {}, ""),
    ],
)
def test_the_full_message_ends_with_the_avoidability(
    avoidable: Answer | None, assessed: dict[str, Any], words: str
) -> None:
    verdict = replace(
        COLLISION, avoidable=avoidable, evidence={**EVIDENCE, "avoidability": assessed}
    )
    assert avoidability_words(verdict) == words
    ending = f" {words[0].upper()}{words[1:]}." if words else ""
    assert full_message(verdict) == COLLISION.message + ending
    # Only a violation has it.
    assert full_message(replace(verdict, outcome=Outcome.PASSED)) == COLLISION.message


def test_a_reason_that_is_an_event_of_the_chain_is_said_once() -> None:
    red = "the ego came into the junction on red"
    chain = f"4.2 s before, both were about to meet; 1.9 s before, {red}"
    assert explain_collision(red, None) == red
    assert explain_collision(red, chain) == chain
    assert explain_collision("the ego ran into the other", chain) == (
        f"the ego ran into the other. {chain.capitalize()}"
    )
    verdict = replace(
        COLLISION, evidence={**EVIDENCE, "reason": red, "avoidability": {"chain": chain}}
    )
    assert failure_sentence(verdict, town="grid").count(red) == 1
