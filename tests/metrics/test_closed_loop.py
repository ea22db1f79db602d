"""nuPlan's closed-loop score and its parts, with values computed by hand."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from drivora_service.metrics.closed_loop import MULTIPLIERS, WEIGHTS, closed_loop_score
from drivora_service.metrics.free_flow import free_flow
from drivora_service.metrics.projected_contact import contact_projected
from drivora_service.observations.run_view import EgoView, RunView
from drivora_service.observations.trace import Contact, Light, Role, TerminalEvent
from drivora_service.testing.networks import CROSSING, WEST
from drivora_service.testing.traces import Motion, SyntheticActor
from tests.metrics.streets import at_speeds, ego_on_road, straight, trace_of, values_of, view_of
from tests.simulation.episodes import ego as idm_ego
from tests.simulation.episodes import network, place, run, scenario

FULL = dict.fromkeys((*MULTIPLIERS, *WEIGHTS), 1.0)


def score(**parts: float | None) -> float | None:
    return closed_loop_score({**FULL, **{f"nuplan_{k}": v for k, v in parts.items()}})


def test_multipliers_multiply_and_the_rest_is_weighed() -> None:
    assert score() == 1.0
    assert score(progress_to_free_flow=0.6) == pytest.approx((3.0 + 5.0 + 4.0 + 2.0) / 16.0)
    assert score(time_to_collision=0.0) == pytest.approx(11.0 / 16.0)
    assert score(speed_limit=0.5) == pytest.approx(14.0 / 16.0)
    assert score(comfort=0.0) == pytest.approx(14.0 / 16.0)
    assert score(no_at_fault_collision=0.5, driving_direction=0.5, comfort=0.0) == pytest.approx(
        0.25 * 14.0 / 16.0
    )
    for multiplier in MULTIPLIERS:
        assert closed_loop_score({**FULL, multiplier: 0.0}) == 0.0


def test_what_is_missing_makes_no_score_unless_that_is_0_anyway() -> None:
    for part in FULL:
        assert closed_loop_score({**FULL, part: None}) is None
    assert score(comfort=None, drivable_area=0.0) == 0.0
    assert score(no_at_fault_collision=None, making_progress=0.0) == 0.0


# Progress. The limit of the road is 10 m/s, and a free drive gains 1.8 m/s² up to it.


def progress(view: EgoView) -> tuple[float, float, float]:
    found = free_flow(view)
    assert found is not None
    return found.seconds, found.own, found.free


def test_a_free_drive_from_a_standstill() -> None:
    # 10 m/s after 5.556 s and 27.78 m; in 9.95 s (the last row) it has come to 71.72 m.
    view = view_of(ego_on_road(at_speeds([0.0] * 20 + [5.0] * 180), 100.0))
    seconds, own, free = progress(view)
    assert seconds == pytest.approx(9.95)
    assert own == pytest.approx(179 * 0.25)
    assert free == pytest.approx(10.0 * 9.95 - 10.0**2 / (2 * 1.8), rel=1e-4)


def test_the_comparison_ends_when_the_free_drive_arrives() -> None:
    # 60 m at 10 m/s: 6 s, after which the ego at 4 m/s has come to 24 m; it arrives after 15 s.
    motion = at_speeds([10.0] + [4.0] * 310)
    motion.states[0, 3] = 10.0
    seconds, own, free = progress(view_of(ego_on_road(motion, 60.0)))
    assert (seconds, own, free) == pytest.approx((6.0, 24.3, 60.0))


def test_at_a_signal_that_is_not_green_the_free_drive_stops_as_well() -> None:
    # 10 m/s for 2 s, 10 s of standstill at 20 m, 10 m/s again: 49.5 m within 14.95 s.
    speeds = [10.0] * 40 + [0.0] * 200 + [10.0] * 60
    motion = at_speeds(speeds)
    motion.states[:, 3] = speeds
    stands = np.array(speeds) == 0.0

    def waiting_at(light: Light) -> tuple[float, float, float]:
        shown = np.where(stands, light, Light.NONE)
        distance = np.where(stands, 2.0, np.nan)
        return progress(view_of(ego_on_road(motion, 200.0, light=shown, light_distance=distance)))

    assert waiting_at(Light.GREEN) == pytest.approx((14.95, 49.5, 149.5))
    # It brakes at 1.8 m/s² from the 8.49 m/s from which it stops within 20 m: 4.71 s. In what is
    # left of 4.95 s it accelerates at 1.8 m/s².
    seconds, own, free = waiting_at(Light.RED)
    assert (seconds, own) == pytest.approx((4.95, 49.5))
    to_the_line = math.sqrt(2 * 1.8 * 20.0) / 1.8
    assert free == pytest.approx(20.0 + 0.9 * (4.95 - to_the_line) ** 2, rel=0.02)


@pytest.mark.parametrize(
    ("own", "free", "ratio"),
    [
        (50.0, 100.0, 0.5),
        (120.0, 100.0, 1.0),
        (0.0, 100.0, 0.02),
        (-1.9, 100.0, 0.02),
        (-2.1, 100.0, 0.0),
        (0.0, 1.0, 1.0),
        (-2.1, 1.0, 0.0),
    ],
)
def test_ratio_of_progress(own: float, free: float, ratio: float) -> None:
    found = free_flow(view_of(ego_on_road(straight(5.0, 20), 100.0)))
    assert found is not None
    assert replace(found, own=own, free=free).ratio == pytest.approx(ratio)


@pytest.mark.parametrize(("speed", "makes"), [(1.9, 0.0), (2.1, 1.0)])
def test_progress_is_made_from_a_fifth_on(speed: float, makes: float) -> None:
    # Beside a free drive that has 10 m/s from the first moment on.
    motion = straight(speed, 200)
    motion.states[0, 3] = 10.0
    values = values_of(ego_on_road(motion, 200.0, end=TerminalEvent.TIME_LIMIT))
    assert values["nuplan_progress_to_free_flow"] == pytest.approx(speed / 10.0)
    assert values["nuplan_making_progress"] == makes
    assert (values["nuplan_closed_loop"] == 0.0) is (makes == 0.0)


def test_no_progress_without_a_place_on_the_route() -> None:
    values = values_of(ego_on_road(straight(5.0, 100), 100.0, route_s=np.nan))
    assert values["nuplan_progress_to_free_flow"] is None
    assert values["nuplan_closed_loop"] is None
    far = ego_on_road(straight(5.0, 100), 100.0, route=np.array([(0.0, 900.0), (100.0, 900.0)]))
    assert values_of(far)["nuplan_progress_to_free_flow"] is None


@pytest.mark.parametrize(
    ("town", "start", "end", "least"),
    [
        ("tee-town", ("harbour_0_0", 60), ("ferry_1_0", 60), 0.85),
        ("roundabout", None, None, 0.85),
        ("highway", ("eb_1_1", 20), ("eb_a_decelerate_0", 220), 0.85),
        # It stops at two signals, more gently than the free drive does.
        ("signal-grid", ("castle_1_1", 20), ("castle_3_1", 50), 0.75),
    ],
)
def test_idm_on_an_empty_road_keeps_up_with_the_free_drive(
    town: str, start: Any, end: Any, least: float
) -> None:
    roads = network(town)
    if start is None:
        long = [lane for lane in roads.lanes if not lane.is_internal and lane.arc[-1] > 60.0]
        start, end = (long[0].id, 10.0), (long[0].id, float(long[0].arc[-1]) - 5.0)
    what = scenario(
        idm_ego(place(*start, on=town), place(*end, on=town), initial_speed=5.0),
        on=town,
        seconds=90.0,
    )
    trace = run(what)
    found = free_flow(RunView(trace, roads).egos[0])
    assert found is not None
    assert least < found.ratio <= 1.0
    assert found.free > 40.0


# Time to collision: boxes of 4.5 m, so that centres 4.5 m apart on one line touch.


def projected(other: SyntheticActor, *, speed: float = 10.0, **fields: Any) -> bool:
    return contact_projected(view_of(ego_on_road(straight(speed, 1), 100.0, **fields), other))


def other_at(x: float, y: float = 0.0, speed: float = 0.0, **more: Any) -> SyntheticActor:
    yaw = more.pop("yaw", 0.0)
    return SyntheticActor(motion=Motion.steady(x, y, steps=1, speed=speed, yaw=yaw), **more)


def test_boxes_that_meet_within_nine_tenths_of_a_second() -> None:
    # At 10 m/s: 13.4 m between the centres leave 8.9 m and 0.89 s.
    assert projected(other_at(13.4))
    # 0.94 s: at 0.9 s they have not met yet, and 1.0 s is beyond the bound.
    assert not projected(other_at(4.5 + 9.4))
    assert not projected(other_at(13.4, speed=10.0))
    assert projected(other_at(13.4 + 8.0, speed=10.0, yaw=math.pi))


@pytest.mark.parametrize(
    ("y", "counts"),
    [(1.7, True), (1.9, False)],  # 1.8 m wide
)
def test_boxes_that_pass_each_other(y: float, counts: bool) -> None:
    assert projected(other_at(12.0, y)) is counts


def test_an_ego_that_stands_endangers_no_actor() -> None:
    coming = other_at(10.0, speed=12.0, yaw=math.pi)
    assert not projected(coming, speed=0.004)
    assert projected(coming, speed=0.006)


def test_those_beside_count_only_between_lanes_off_the_road_and_in_junctions() -> None:
    # From the right, 70 degrees from the heading, into the ego's side within 0.9 s.
    beside = other_at(4.0, -9.0, speed=10.0, yaw=math.pi / 2)
    assert not projected(beside)
    assert projected(beside, lane=CROSSING)
    assert projected(beside, lane=-1)
    assert projected(beside, lane_lateral=1.0)  # reaches 0.15 m over the edge of its lane
    assert not projected(beside, lane_lateral=0.8)
    behind = other_at(-9.0, 0.0, speed=30.0)
    assert not projected(behind, lane=CROSSING)


def test_behind_is_150_degrees_from_the_heading_seen_from_the_rear_axle() -> None:
    found = []
    for degrees in (148.0, 152.0):
        x = 8.0 * math.cos(math.radians(degrees)) - 4.5 * 1.461 / 5.176
        y = 8.0 * math.sin(math.radians(degrees))
        # Beside the ego's own 10 m/s it comes at 12 m/s straight to its centre.
        vx, vy = 10.0 - 12.0 * x / math.hypot(x, y), -12.0 * y / math.hypot(x, y)
        other = other_at(x, y, speed=math.hypot(vx, vy), yaw=math.atan2(vy, vx))
        found.append(projected(other, lane=CROSSING))
    assert found == [True, False]


def test_places_are_sampled_every_tenth_of_a_second() -> None:
    # A small one at 40 m/s is in the ego's way for 0.058 s: from 0.371 s on, or from 0.421 s on.
    small = {"speed": 40.0, "yaw": math.pi / 2, "length": 0.5, "width": 0.5}
    for y, counts in ((-16.0, True), (-18.0, False)):
        assert projected(other_at(6.0, y, **small), lane=CROSSING) is counts


def test_ahead_is_seen_from_the_rear_axle() -> None:
    # 30 degrees from the axle, 1.27 m behind the centre, are more from the centre.
    seen = [other_at(3.0, 4.27 * math.tan(math.radians(a)), speed=4.0, yaw=-2.0) for a in (29, 31)]
    assert [projected(one) for one in seen] == [True, False]


def test_a_collision_at_fault_has_no_time_left_and_another_is_over() -> None:
    steps = 120
    front = SyntheticActor(motion=straight(0.0, steps, 44.4), role=Role.NPC_OBSTACLE)
    ego = ego_on_road(straight(8.0, steps), 200.0, end=TerminalEvent.COLLISION, end_step=100)
    touch = Contact(step=100, ego=0, other=1)
    hit = values_of(ego, front, contacts=[touch])
    assert hit["nuplan_no_at_fault_collision"] == 0.5
    assert hit["nuplan_time_to_collision"] == 0.0
    rammer = SyntheticActor(motion=straight(10.0, steps, -14.4), role=Role.NPC_VEHICLE)
    rammed = values_of(ego, rammer, contacts=[touch])
    assert rammed["nuplan_no_at_fault_collision"] == 1.0
    assert rammed["nuplan_time_to_collision"] == 1.0
    # The one that was touched does not count from then on, others do.
    trace = trace_of(ego, front, contacts=[Contact(step=0, ego=0, other=1)])
    assert not contact_projected(RunView(trace, network("tee-town")).egos[0])


# Speed, direction.


def test_overspeed_is_integrated_over_time() -> None:
    # 12 m/s for 2 s where 10 are allowed, then 9 m/s for 6 s: 4 m in 8 s.
    speeds = np.array([12.0] * 40 + [9.0] * 121)
    motion = at_speeds(speeds)
    motion.states[:, 3] = speeds
    values = values_of(ego_on_road(motion, 100.0))
    excess = 2.0 * (39 * 0.05) + 0.5 * 2.0 * 0.05
    assert values["nuplan_speed_limit"] == pytest.approx(1.0 - excess / (2.23 * 8.0))
    fast = values_of(ego_on_road(straight(13.0, 100), 60.0))
    assert fast["nuplan_speed_limit"] == 0.0
    assert values_of(ego_on_road(straight(13.0, 1), 60.0))["nuplan_speed_limit"] is None


@pytest.mark.parametrize(("speed", "value"), [(1.9, 1.0), (2.1, 0.5), (5.9, 0.5), (6.1, 0.0)])
def test_direction(speed: float, value: float) -> None:
    motion = straight(speed, 100, y=7.0)
    values = values_of(ego_on_road(motion, 60.0, lane=WEST, lane_heading=math.pi))
    assert values["nuplan_driving_direction"] == value


def test_a_whole_score_by_hand() -> None:
    # 8 m/s where 10 m/s are allowed, and one obstacle hit at fault after 37.2 m (4.65 s).
    ego = ego_on_road(straight(8.0, 200), 70.0, end=TerminalEvent.COLLISION, end_step=93)
    cone = SyntheticActor(
        id="cone", motion=straight(0.0, 200, 39.9), role=Role.NPC_OBSTACLE, length=1.0
    )
    values = values_of(ego, cone, contacts=[Contact(step=93, ego=0, other=1)])
    free = 10.0 + 10.0 * (93 * 0.05 - 2.0 / 1.8)
    assert values["nuplan_progress_to_free_flow"] == pytest.approx(37.2 / free)
    assert values["nuplan_closed_loop"] == pytest.approx(
        0.5 * (5.0 * 37.2 / free + 0.0 + 4.0 + 2.0) / 16.0
    )
