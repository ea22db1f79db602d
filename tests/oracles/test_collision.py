from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from drivora_service.geometry.boxes import boxes_overlap
from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import Actor, Col, Contact, Role, TerminalEvent, Trace
from drivora_service.oracles.collision import Collision
from drivora_service.oracles.verdict import Outcome, Verdict
from drivora_service.testing.networks import CROSSING, EAST, straight_road
from drivora_service.testing.traces import Motion, SyntheticActor, SyntheticEgo, make_trace
from tests.oracles.judging import on_lane

STEPS = 100


def collide(
    ego: SyntheticEgo, *others: SyntheticActor, contacts: Sequence[Contact] | None = None
) -> tuple[Verdict, ...]:
    """Judges with the contacts that really are there, unless some are given."""
    trace = make_trace([ego], others)
    found = _contacts(trace) if contacts is None else contacts
    last = max((contact.step for contact in found), default=STEPS - 1)
    trace = replace(trace, contacts=tuple(found), ego_end_steps=(last,))
    return Collision().judge(RunView(trace, straight_road()))


def _box(trace: Trace, actor: Actor, step: int) -> tuple[float, ...]:
    pose = trace.states[step, actor.row, [Col.X, Col.Y, Col.YAW]]
    return (*pose.tolist(), actor.length, actor.width)


def _contacts(trace: Trace) -> list[Contact]:
    found = []
    for other in trace.actors[1:]:
        for step in range(trace.step_count):
            one, two = (_box(trace, actor, step) for actor in (trace.actors[0], other))
            if trace.present[step, other.row] and boxes_overlap(*one, *two):
                found.append(Contact(step=step, ego=0, other=other.row))
                break
    first = min((contact.step for contact in found), default=0)
    return [contact for contact in found if contact.step == first]


def steady(x: float, y: float, speed: float = 0.0, yaw: float = 0.0) -> Motion:
    return Motion.steady(x, y, steps=STEPS, speed=speed, yaw=yaw)


def test_no_actor_touched() -> None:
    (verdict,) = collide(on_lane(motion=steady(0.0, 0.0, 10.0)))
    assert verdict.outcome is Outcome.PASSED


def test_hitting_a_standing_vehicle_is_the_egos_fault() -> None:
    (verdict,) = collide(
        on_lane(motion=steady(0.0, 0.0, 10.0)), SyntheticActor(motion=steady(20.0, 0.5))
    )
    assert verdict.outcome is Outcome.VIOLATED
    assert verdict.at_fault
    assert verdict.counterpart == "npc"
    assert verdict.evidence["face"] == "front"
    assert verdict.evidence["reason"].startswith("the other had stood")
    assert verdict.evidence["rule"] == "standing"
    assert verdict.evidence["relative_speed"] == pytest.approx(10.0)
    assert verdict.step == 32
    assert verdict.time == pytest.approx(1.6)
    assert verdict.location == pytest.approx((16.0, 0.0))


def test_hitting_a_moving_vehicle_with_the_front_is_the_egos_fault() -> None:
    (verdict,) = collide(
        on_lane(motion=steady(0.0, 0.0, 12.0)), SyntheticActor(motion=steady(18.0, 0.0, 4.0))
    )
    assert verdict.at_fault
    assert verdict.evidence["rule"] == "following"


def test_being_hit_from_behind_is_not() -> None:
    (verdict,) = collide(
        on_lane(motion=steady(0.0, 0.0, 3.0)), SyntheticActor(motion=steady(-10.0, 0.2, 10.0))
    )
    assert verdict.at_fault is False
    assert verdict.evidence["face"] == "rear"


def test_a_fast_grazing_hit_from_behind_is_seen_at_its_first_touch() -> None:
    # At the end of the step the boxes share a strip of 1.4 m along the ego's side.
    grazing = SyntheticActor(motion=steady(-8.6, 1.5, 40.0))
    (verdict,) = collide(on_lane(motion=steady(0.0, 0.0, 3.0)), grazing)
    assert verdict.evidence["face"] == "rear"
    assert verdict.at_fault is False


def test_backing_into_an_actor_is() -> None:
    (verdict,) = collide(
        on_lane(motion=steady(0.0, 0.0, -3.0)), SyntheticActor(motion=steady(-10.0, 0.0, 0.5))
    )
    assert verdict.at_fault
    assert verdict.evidence["reason"] == "the ego went backwards"


@pytest.mark.parametrize(("yaw", "x", "y"), [(0.0, -10.0, 0.0), (math.pi, 10.0, 0.0)])
def test_a_stationary_ego_that_is_hit_is_not_at_fault(yaw: float, x: float, y: float) -> None:
    other = SyntheticActor(motion=steady(x, y, 10.0, yaw))
    (verdict,) = collide(on_lane(motion=steady(0.0, 0.0)), other)
    assert verdict.at_fault is False
    assert not verdict.evidence["nuplan_at_fault"]


@pytest.mark.parametrize(("speed", "at_fault"), [(0.04, False), (0.06, True)])
def test_for_nuplan_an_ego_stands_up_to_five_centimetres_a_second(
    speed: float, at_fault: bool
) -> None:
    oncoming = SyntheticActor(motion=steady(10.0, 0.0, 5.0, math.pi))
    (verdict,) = collide(on_lane(motion=steady(0.0, 0.0, speed)), oncoming)
    assert verdict.evidence["nuplan_at_fault"] is at_fault
    assert verdict.at_fault is False


def test_being_touched_at_the_side_in_the_own_lane_is_not_the_egos_fault() -> None:
    drifting = steady(1.0, 3.5, 10.0)
    drifting.states[:, Col.Y] -= 0.02 * np.arange(STEPS)
    (verdict,) = collide(on_lane(motion=steady(0.0, 0.0, 10.0)), SyntheticActor(motion=drifting))
    assert verdict.evidence["face"] == "side"
    assert verdict.at_fault is False


def test_touching_at_the_side_while_changing_lanes_is() -> None:
    changing = steady(1.0, 0.0, 10.0)
    changing.states[:, Col.Y] += 0.02 * np.arange(STEPS)
    ego = on_lane(motion=changing, lane_lateral=changing.states[:, Col.Y].copy())
    (verdict,) = collide(ego, SyntheticActor(motion=steady(0.0, 3.2, 10.0)))
    assert verdict.evidence["face"] == "side"
    assert verdict.at_fault
    assert verdict.evidence["reason"] == "the ego came into the lane of the other"


def test_in_a_junction_whose_right_of_way_is_unknown_nothing_can_be_told() -> None:
    ego = on_lane(motion=steady(502.0, 1.0, 2.0), lane=CROSSING, lane_lateral=1.0)
    crossing = SyntheticActor(motion=steady(506.0, -12.0, 10.0, math.pi / 2))
    (verdict,) = collide(ego, crossing)
    assert verdict.evidence["face"] == "side"
    assert verdict.at_fault is None
    assert verdict.undetermined
    assert not verdict.evidence["nuplan_at_fault"]


def test_where_both_are_off_the_road_nothing_can_be_told() -> None:
    ego = on_lane(motion=steady(0.0, -6.0, 10.0), lane=-1, lane_lateral=np.nan)
    drifting = steady(0.0, -9.5, 10.0)
    drifting.states[:, Col.Y] += 0.02 * np.arange(STEPS)
    (verdict,) = collide(ego, SyntheticActor(motion=drifting))
    assert verdict.evidence["face"] == "side"
    assert verdict.undetermined
    assert verdict.evidence["nuplan_at_fault"]


@pytest.mark.parametrize(
    ("ego_y", "other_y", "at_fault"), [(-1.2, -4.6, False), (-4.6, -1.2, True)]
)
def test_at_the_edge_of_the_road_the_party_beside_it_is_responsible(
    ego_y: float, other_y: float, at_fault: bool
) -> None:
    ego, other = steady(0.0, ego_y, 10.0), steady(0.5, other_y, 10.0)
    coming = ego if ego_y < other_y else other
    coming.states[:, Col.Y] += 0.02 * np.arange(STEPS)
    on_road = {"lane_lateral": ego_y} if ego_y > other_y else {"lane": -1, "lane_lateral": np.nan}
    (verdict,) = collide(on_lane(motion=ego, **on_road), SyntheticActor(motion=other))
    assert verdict.evidence["rule"] == "off_the_road"
    assert verdict.evidence["reason"].endswith("was beside the road")
    assert verdict.at_fault is at_fault


def test_a_vehicle_from_the_side_into_the_egos_door_is_not_the_egos_fault() -> None:
    # After a whole step the other would be deep inside the ego: the first touch decides.
    ego = on_lane(motion=steady(0.0, 0.0, 5.0))
    rammer = SyntheticActor(motion=steady(8.0, -38.0, 30.0, math.pi / 2))
    (verdict,) = collide(ego, rammer)
    assert verdict.evidence["face"] == "side"
    assert verdict.at_fault is False


def test_an_obstacle_turned_by_its_own_yaw() -> None:
    # Lengthwise the plank lies beside the lane; turned by its yaw it lies across it.
    plank: dict[str, Any] = {"role": Role.NPC_OBSTACLE, "length": 6.0, "width": 0.2, "id": "plank"}
    ego = on_lane(motion=steady(0.0, 0.0, 10.0))
    assert collide(ego, SyntheticActor(motion=steady(20.0, 2.5), **plank))[0].at_fault is None
    across = SyntheticActor(motion=steady(20.0, 2.5, yaw=math.pi / 2), **plank)
    (verdict,) = collide(ego, across)
    assert verdict.at_fault
    assert verdict.evidence["counterpart_role"] == "npc_obstacle"


def test_a_walker_into_the_side_of_a_moving_ego() -> None:
    walker = SyntheticActor(
        id="walker",
        role=Role.NPC_WALKER,
        length=0.5,
        width=0.5,
        motion=steady(4.0, -3.0, 1.5, math.pi / 2),
    )
    (verdict,) = collide(on_lane(motion=steady(0.0, 0.0, 3.0)), walker)
    assert verdict.evidence["face"] == "side"
    assert verdict.at_fault is False


def test_an_actor_that_appears_in_the_ego_is_not_the_egos_fault() -> None:
    appearing = SyntheticActor(motion=steady(12.0, 0.0), present=np.arange(STEPS) >= 25)
    (verdict,) = collide(on_lane(motion=steady(0.0, 0.0, 10.0)), appearing)
    assert verdict.at_fault is False
    assert "appeared" in verdict.evidence["reason"]


def test_a_compound_collision_is_judged_for_each_counterpart() -> None:
    # Pushed from behind and into the one in front at the same step: two collisions, one at fault.
    ego = on_lane(motion=steady(0.0, 0.0, 10.0))
    front = SyntheticActor(id="front", motion=steady(20.0, 0.0))
    behind = SyntheticActor(id="behind", motion=steady(-20.0, 0.0, 20.0))
    touch = 32
    verdicts = collide(
        ego,
        front,
        behind,
        contacts=[Contact(step=touch, ego=0, other=1), Contact(step=touch, ego=0, other=2)],
    )
    by_other = {verdict.counterpart: verdict.at_fault for verdict in verdicts}
    assert by_other == {"front": True, "behind": False}


def test_the_same_actor_counts_once() -> None:
    contacts = [Contact(step=32, ego=0, other=1), Contact(step=60, ego=0, other=1)]
    ego = on_lane(motion=steady(0.0, 0.0, 10.0))
    verdicts = collide(ego, SyntheticActor(motion=steady(20.0, 0.0)), contacts=contacts)
    assert [verdict.step for verdict in verdicts] == [32]


def test_a_collision_of_two_egos_is_judged_for_both() -> None:
    first = on_lane(id="first", motion=steady(0.0, 0.0, 12.0), end_step=STEPS - 1)
    second = on_lane(id="second", motion=steady(12.0, 0.0, 4.0), end=TerminalEvent.COLLISION)
    contact = Contact(step=19, ego=0, other=1)
    trace = make_trace([first, second], contacts=[contact])
    one, two = Collision().judge(RunView(trace, straight_road()))
    assert (one.ego, one.counterpart, one.at_fault) == ("first", "second", True)
    assert (two.ego, two.counterpart, two.at_fault) == ("second", "first", False)


@pytest.mark.parametrize("turn", [0.0, 0.7, math.pi / 2, -2.5])
def test_nuplans_class_does_not_depend_on_where_east_is(turn: float) -> None:
    cos, sin = math.cos(turn), math.sin(turn)

    def turned(motion: Motion) -> Motion:
        states = motion.states.copy()
        for x, y in ((Col.X, Col.Y), (Col.VX, Col.VY)):
            states[:, x] = motion.states[:, x] * cos - motion.states[:, y] * sin
            states[:, y] = motion.states[:, x] * sin + motion.states[:, y] * cos
        states[:, Col.YAW] += turn
        return Motion(states=states)

    ego = on_lane(motion=turned(steady(0.0, 0.0, 12.0)), lane=EAST, lane_heading=turn)
    (front,) = collide(ego, SyntheticActor(motion=turned(steady(15.0, 1.0, 4.0))))
    (rear,) = collide(ego, SyntheticActor(motion=turned(steady(-15.0, 1.0, 25.0))))
    assert (front.evidence["face"], front.evidence["nuplan_at_fault"]) == ("front", True)
    assert (rear.evidence["face"], rear.evidence["nuplan_at_fault"]) == ("rear", False)
