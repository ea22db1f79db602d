"""Violations that only follow from another one."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivora_service.oracles.verdict import Outcome, Verdict
from drivora_service.oracles.verdicts.consequences import fold_consequences

END = 40.0


def violated(oracle: str, time: float | None = None, **options: Any) -> Verdict:
    options.setdefault("ego", "ego")
    return Verdict(oracle=oracle, outcome=Outcome.VIOLATED, message="", time=time, **options)


def causes(*verdicts: Verdict) -> dict[str, str]:
    folded = fold_consequences(verdicts, {"ego": END, "other": END})
    assert [one.oracle for one in folded] == [one.oracle for one in verdicts]
    return {one.oracle: one.follows for one in folded if one.follows}


def missed(reason: str) -> Verdict:
    return violated("destination", END, evidence={"reason": reason})


STOOD = violated("blocked", 30.0, evidence={"since": 10.0, "until": END})


@pytest.mark.parametrize(
    ("verdicts", "expected"),
    [
        # What ended the part of an ego made it miss its destination.
        ((violated("collision", END), missed("collision")), {"destination": "collision"}),
        ((violated("route_deviation", 9.0), missed("route_deviation")),
         {"destination": "route_deviation"}),
        ((STOOD, missed("stuck")), {"destination": "blocked"}),
        # ... and what kept it standing until the time was over.
        ((STOOD, missed("timeout")), {"destination": "blocked"}),
        ((violated("blocked", 20.0, evidence={"since": 5.0, "until": 25.0}), missed("timeout")),
         {}),
        # A slow drive is a failure of its own, whatever else happened on the way.
        ((violated("red_light", 3.0), missed("timeout")), {}),
        ((violated("collision", 3.0), missed("late")), {}),
        # An ego that waits in a cycle, or stands in a junction, is blocked by that.
        ((violated("deadlock", 20.0), STOOD, missed("stuck")),
         {"blocked": "deadlock", "destination": "deadlock"}),
        ((violated("junction_blocking", 15.0, evidence={"since": 10.0, "until": END}), STOOD),
         {"blocked": "junction_blocking"}),
        ((violated("junction_blocking", 3.0, evidence={"since": 1.0, "until": 5.0}), STOOD), {}),
        # A wreck stands; an ego that is hit where it stands was blocked before.
        ((violated("collision", 8.0), STOOD), {"blocked": "collision"}),
        ((violated("collision", 35.0), STOOD), {}),
        # Who touched it was near before.
        ((violated("collision", 8.0, counterpart="v"), violated("near_miss", 7.0, counterpart="v"),
          violated("near_miss", 4.0, counterpart="w")), {"near_miss": "collision"}),
        # A breach before a collision is one of its own, and so is the collision.
        ((violated("failure_to_yield", 7.0, counterpart="v"),
          violated("collision", 8.0, counterpart="v")), {}),
        # Of another ego, nothing follows.
        ((violated("collision", END, ego="other"), missed("collision")), {}),
    ],
)  # fmt: skip
def test_what_follows_from_what(verdicts: tuple[Verdict, ...], expected: dict[str, str]) -> None:
    assert causes(*verdicts) == expected


def test_only_the_near_miss_of_who_touched_it_follows() -> None:
    near = violated("near_miss", 4.0, counterpart="w")
    folded = fold_consequences((violated("collision", 8.0, counterpart="v"), near), {"ego": END})
    assert folded[1] is near


@given(
    st.lists(
        st.builds(
            lambda oracle, time, reason, outcome: Verdict(
                oracle=oracle, ego="ego", outcome=outcome, message="", time=time,
                evidence={"reason": reason},
            ),
            st.sampled_from(
                ["collision", "blocked", "deadlock", "destination", "near_miss", "off_road"]
            ),
            st.none() | st.floats(0.0, END),
            st.sampled_from(["collision", "stuck", "timeout", "route_deviation", "late"]),
            st.sampled_from(Outcome),
        ),
        max_size=6,
    )
)  # fmt: skip
def test_a_cause_is_a_violation_that_follows_from_none_of_its_consequences(
    verdicts: list[Verdict],
) -> None:
    folded = fold_consequences(verdicts, {"ego": END})
    violated_oracles = {one.oracle for one in verdicts if one.outcome is Outcome.VIOLATED}
    edges = {(one.oracle, one.follows) for one in folded if one.follows}
    for one in folded:
        if one.follows:
            assert one.outcome is Outcome.VIOLATED
            assert one.follows in violated_oracles
            assert one.follows != one.oracle
    # Whatever follows ends at a violation that follows from none.
    for start, _ in edges:
        seen, place = set(), start
        while place not in seen and any(a == place for a, _ in edges):
            seen.add(place)
            place = next(b for a, b in edges if a == place)
        assert place not in seen
