"""AVFuzzer's feedback: gap, safety potential, and the actors that count."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from drivora_service.errors import SearchError
from drivora_service.feedback.avfuzzer import SAFETY_MARGIN, AvfuzzerFeedback, braking_distance
from drivora_service.feedback.catalogue import FeedbackCatalogue
from drivora_service.feedback.measurement import FeedbackChoice
from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import Col, Role, TerminalEvent
from drivora_service.testing.networks import EAST, straight_road
from drivora_service.testing.traces import Motion, SyntheticActor, SyntheticEgo, make_trace

ROAD = straight_road()
STEPS = 100
FAR = 130.0


def ego(speed: float = 10.0, **fields: Any) -> SyntheticEgo:
    defaults: dict[str, Any] = {
        "motion": Motion.steady(0.0, 0.0, steps=STEPS, speed=speed),
        "lane": EAST,
        "lane_heading": 0.0,
    }
    return SyntheticEgo(**{**defaults, **fields})


def other(x: float, y: float, speed: float = 10.0, **fields: Any) -> SyntheticActor:
    yaw = fields.pop("yaw", 0.0)
    motion = Motion.steady(x, y, steps=STEPS, speed=speed, yaw=yaw)
    return SyntheticActor(**{"motion": motion, **fields})


def margin(*actors: SyntheticEgo | SyntheticActor) -> float | None:
    egos = [one for one in actors if isinstance(one, SyntheticEgo)]
    others = [one for one in actors if isinstance(one, SyntheticActor)]
    measured = AvfuzzerFeedback().measure(RunView(make_trace(egos, others), ROAD))
    assert tuple(measured.objectives) == AvfuzzerFeedback().objectives
    return measured.objectives[SAFETY_MARGIN]


@pytest.mark.parametrize(("speed", "needed"), [(0.0, 0.0), (3.0, 0.1638), (10.0, 7.2947)])
def test_the_braking_distance_is_the_papers_and_never_negative(speed: float, needed: float) -> None:
    assert braking_distance(np.array([speed]))[0] == pytest.approx(needed)


def test_behind_a_leader_the_gap_and_the_room_to_stop_count_half_each() -> None:
    # 15 m between the centres, 10.5 m between the boxes.
    assert margin(ego(), other(15.0, 0.0)) == pytest.approx(0.5 * 10.5 + 0.5 * (10.5 - 7.2947))


def test_a_leader_is_within_twenty_metres() -> None:
    assert margin(ego(), other(20.0, 0.0)) == pytest.approx(0.5 * 15.5 + 0.5 * (15.5 - 7.2947))
    assert margin(ego(), other(20.1, 0.0)) == pytest.approx(0.5 * 15.6 + 0.5 * FAR)


def test_a_leader_is_in_the_lane() -> None:
    def gap(y: float) -> float:
        return math.hypot(5.5, y - 1.8)

    assert margin(ego(), other(10.0, 2.0)) == pytest.approx(
        0.5 * gap(2.0) + 0.5 * (5.5 - 7.2947), abs=0.02
    )
    assert margin(ego(), other(10.0, 2.1)) == pytest.approx(0.5 * gap(2.1) + 0.5 * FAR, abs=0.02)


def test_each_term_has_its_own_worst_moment() -> None:
    # The nearest is beside, the leader ahead; both count.
    found = margin(ego(), other(0.0, 3.0), other(15.0, 0.0))
    assert found == pytest.approx(0.5 * 1.2 + 0.5 * (10.5 - 7.2947))


def test_the_worst_moment_of_a_run_counts() -> None:
    # The leader is 4 m/s slower for 4.95 s: 19.8 m are lost of the 25.5 m between the boxes.
    found = margin(ego(), other(30.0, 0.0, speed=6.0))
    assert found == pytest.approx(0.5 * 5.7 + 0.5 * (5.7 - 7.2947))


def test_a_collision_at_speed_is_the_worst() -> None:
    collided = ego(end=TerminalEvent.COLLISION, end_step=46)
    assert margin(collided, other(27.0, 0.0, speed=0.0)) == pytest.approx(0.5 * -7.2947)


def test_one_behind_does_not_count_unless_the_ego_pulls_in_before_it() -> None:
    # At the end 2.475 m are lost of the 10.5 m between the boxes.
    behind = other(-15.0, 0.0, speed=12.5)
    straight = margin(ego(speed=12.0), behind)
    assert straight == pytest.approx(0.5 * 8.025 + 0.5 * FAR)
    turned = Motion.steady(0.0, 0.0, steps=STEPS, speed=12.0)
    turned.states[:, Col.YAW] = math.radians(2.0)
    pulled_in = margin(ego(motion=turned), behind)
    # The one behind has to stop: its 12.5 m/s count.
    assert pulled_in == pytest.approx(0.5 * 8.025 + 0.5 * (8.025 - 10.9506), abs=0.05)


@pytest.mark.parametrize(
    "fields", [{"role": Role.NPC_WALKER}, {"yaw": math.pi}, {"role": Role.NPC_OBSTACLE}]
)
def test_only_vehicles_of_the_same_direction_are_cut_off(fields: dict[str, Any]) -> None:
    turned = Motion.steady(0.0, 0.0, steps=STEPS)
    turned.states[:, Col.YAW] = math.radians(10.0)
    cut_off = margin(ego(motion=turned), other(-15.0, 0.0, speed=0.0))
    found = margin(ego(motion=turned), other(-15.0, 0.0, speed=0.0, **fields))
    assert cut_off is not None
    assert found is not None
    assert cut_off < 0.25 * FAR
    assert found > 0.5 * FAR


def test_a_walker_in_the_way_is_a_leader() -> None:
    # The ego ends at 49.5 m: 8 m are left between the boxes.
    walker = other(60.0, 0.0, speed=0.0, role=Role.NPC_WALKER, length=0.5, width=0.5)
    assert margin(ego(), walker) == pytest.approx(0.5 * 8.0 + 0.5 * (8.0 - 7.2947))


def test_an_actor_on_another_level_does_not_lead() -> None:
    bridge = other(15.0, 0.0)
    bridge.motion.states[:, Col.Z] = 6.0
    assert margin(ego(), bridge, other(0.0, 50.0)) == pytest.approx(0.5 * 48.2 + 0.5 * FAR)


def test_both_terms_have_an_end() -> None:
    assert margin(ego(), other(0.0, 400.0)) == FAR


def test_alone_nothing_is_measurable() -> None:
    assert margin(ego()) is None


def test_of_several_egos_the_worst_counts() -> None:
    front = ego(id="front", motion=Motion.steady(15.0, 0.0, steps=STEPS, speed=10.0))
    assert margin(front, ego()) == pytest.approx(0.5 * 10.5 + 0.5 * (10.5 - 7.2947))


def test_the_catalogue_makes_it_with_its_parameters() -> None:
    choice = FeedbackChoice(name="avfuzzer", parameters={"reach": 30})
    assert FeedbackCatalogue().create(choice) == AvfuzzerFeedback(reach=30.0)
    with pytest.raises(SearchError, match="reach is -1"):
        FeedbackCatalogue().create(FeedbackChoice(name="avfuzzer", parameters={"reach": -1}))
