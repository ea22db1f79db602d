"""The table of rules: what it is asked, what it must not depend on, and its documentation."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import Col, Contact, Role, Trace
from drivora_service.oracles.collision import Collision
from drivora_service.oracles.responsibility.finding import Fault, Finding
from drivora_service.oracles.responsibility.impact import find_impact
from drivora_service.oracles.responsibility.party import Party
from drivora_service.oracles.responsibility.required_braking import could_brake
from drivora_service.oracles.responsibility.responsibility_judging import find_responsible
from drivora_service.oracles.verdict import Outcome
from drivora_service.scenario.conversion import to_scenario
from drivora_service.testing.networks import straight_road
from drivora_service.testing.traces import Motion, SyntheticActor, make_trace
from tests.oracles.judging import on_lane
from tests.oracles.responsibility.case import Case
from tests.oracles.responsibility.families import all_cases
from tests.oracles.responsibility.judged import collisions, fault, recorded
from tests.oracles.responsibility.ways import town
from tests.simulation.episodes import run

PAGE = Path(__file__).parents[3] / "docs" / "reference" / "oracles.md"
COMPLEMENT = {Fault.EGO: Fault.OTHER, Fault.OTHER: Fault.EGO, Fault.UNKNOWN: Fault.UNKNOWN}
BOTH_AT_FAULT = frozenset(
    {"ego-has-stood-in-oncoming-lane", "ego-runs-into-vehicle-that-stands-the-wrong-way"}
)
"""One stood where it may not, the other could have braked: each answers for its own part."""

NOT_MIRRORED = frozenset({"ego-begins-too-near", "vehicle-appears-in-ego"})
"""An ego that begins too near is not told at fault; the one that it hits is no more so."""


def test_every_rule_is_documented() -> None:
    page = PAGE.read_text()
    rules = {
        verdict.evidence["rule"]
        for case in all_cases()
        for verdict in collisions(case.name).values()
    }
    assert len(rules) >= 12
    for rule in rules:
        assert f"| `{rule}`" in page or f", `{rule}`" in page, rule


def both_ways(trace: Trace, case: Case) -> tuple[Finding, Finding]:
    contact = trace.contacts[0]
    one, two = trace.actors[contact.ego], trace.actors[contact.other]
    first, second = (
        find_responsible(
            trace,
            town(case.town),
            ego,
            other,
            contact.step,
            find_impact(trace, ego, other, contact.step),
            0.05,
        )
        for ego, other in ((one, two), (two, one))
    )
    return first, second


def test_seen_from_the_other_vehicle_the_fault_is_the_complement() -> None:
    compared = 0
    for case in all_cases():
        trace = recorded(case)
        other = trace.actors[trace.contacts[0].other]
        if other.role in (Role.NPC_WALKER, Role.NPC_OBSTACLE) or case.name in NOT_MIRRORED:
            continue
        first, second = both_ways(trace, case)
        if case.name in BOTH_AT_FAULT:
            assert first.fault is second.fault is Fault.EGO
        else:
            assert second.fault is COMPLEMENT[first.fault], (case.name, first, second)
        compared += 1
    assert compared >= 90


@pytest.mark.slow
@pytest.mark.parametrize("step_length", [0.02, 0.1])
def test_the_verdicts_do_not_depend_on_the_step_length(step_length: float) -> None:
    for case in all_cases():
        scenario = replace(to_scenario(case.document(), town(case.town)), step_length=step_length)
        verdicts = Collision().judge(RunView(run(scenario), town(case.town)))
        expected = {case.egos[0].name: case.expected, **case.expected_of}
        assert {verdict.ego: fault(verdict) for verdict in verdicts} == expected, case.name


def follow(gap: float, speed: float, ahead: float) -> tuple[Party, Party, int]:
    """A vehicle that runs into a slower one, ``gap`` metres before it at first."""
    steps = round(gap / (speed - ahead) / 0.05) + 1
    trace = make_trace(
        [on_lane(motion=Motion.steady(0.0, 0.0, steps=steps, speed=speed))],
        [SyntheticActor(motion=Motion.steady(4.5 + gap, 0.0, steps=steps, speed=ahead))],
    )
    road = straight_road()
    one, two = (Party(trace, road, trace.actors[row], steps - 1, 0.0) for row in (0, 1))
    return one, two, steps


@pytest.mark.parametrize(
    ("gap", "speed", "ahead", "in_time"),
    [
        # 1.15 s at the speed difference, and the braking distance with a ramp of 0.6 s.
        (21.5, 10.0, 0.0, True),
        (20.0, 10.0, 0.0, False),
        (9.0, 12.0, 7.0, True),
        (8.0, 12.0, 7.0, False),
    ],
)
def test_the_competent_driver_brakes_as_published(
    gap: float, speed: float, ahead: float, in_time: bool
) -> None:
    one, two, _ = follow(gap, speed, ahead)
    assert could_brake(one, two, 0) is in_time


def test_a_slippery_road_limits_the_braking() -> None:
    one, two, _ = follow(24.0, 10.0, 0.0)
    assert could_brake(one, two, 0)
    one.grip = np.full(one.count, 0.3 * 9.81)
    assert not could_brake(one, two, 0)


def test_the_delay_can_be_left_out() -> None:
    one, two, _ = follow(12.0, 10.0, 0.0)
    assert not could_brake(one, two, 0)
    assert could_brake(one, two, 0, reaction=0.0)


def test_an_ego_that_a_vehicle_jumps_into_is_not_at_fault() -> None:
    steps = 80
    jumping = Motion.steady(30.0, 3.5, steps=steps, speed=4.0)
    step = 50
    jumping.states[step:, Col.Y] -= 3.5
    trace = make_trace(
        [on_lane(motion=Motion.steady(11.0, 0.0, steps=steps, speed=10.0))],
        [SyntheticActor(motion=jumping)],
        contacts=[Contact(step=step, ego=0, other=1)],
    )
    (verdict,) = Collision().judge(RunView(trace, straight_road()))
    assert verdict.at_fault is False
    assert verdict.outcome is Outcome.NOT_MEASURABLE
    assert verdict.evidence["reason"].startswith("npc jumped into the ego")


def test_a_vehicle_that_reports_a_speed_but_does_not_move_stands() -> None:
    # What counts is where it was, not what it says of its speed.
    steps = 80
    parked = Motion.steady(30.0, 0.0, steps=steps)
    parked.states[:, Col.VX] = 5.0
    trace = make_trace(
        [on_lane(motion=Motion.steady(0.0, 0.0, steps=steps, speed=10.0))],
        [SyntheticActor(motion=parked)],
    )
    step = int(np.flatnonzero(trace.states[:, 0, Col.X] > 25.5)[0])
    trace = replace(trace, contacts=(Contact(step=step, ego=0, other=1),), ego_end_steps=(step,))
    (verdict,) = Collision().judge(RunView(trace, straight_road()))
    assert verdict.at_fault
    assert verdict.evidence["rule"] == "standing"
    assert verdict.evidence["other_speed"] == pytest.approx(0.0)
