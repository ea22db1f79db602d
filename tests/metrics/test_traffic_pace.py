"""The ego's pace against the traffic's, with values computed by hand."""

from __future__ import annotations

import numpy as np
import pytest

from drivora_service.metrics.traffic_pace import efficiency, pace_ratios, slow_sections
from drivora_service.observations.run_view import EgoView
from drivora_service.observations.trace import Role, TerminalEvent
from drivora_service.testing.traces import Motion, SyntheticActor
from tests.metrics.streets import at_speeds, ego_on_road, straight, values_of, view_of

STEPS = 241  # 12 s: 96 m at 8 m/s


def beside(speed: float, name: str = "npc", **more: object) -> SyntheticActor:
    return SyntheticActor(id=name, motion=straight(speed, STEPS, y=3.5), **more)  # type: ignore[arg-type]  # fields


def ego(length: float = 96.0, end: TerminalEvent = TerminalEvent.ARRIVED) -> EgoView:
    return view_of(ego_on_road(straight(8.0, STEPS), length, end=end), beside(10.0))


def test_a_section_counts_once_it_is_left() -> None:
    assert pace_ratios(ego(96.0), 4) == pytest.approx([0.8] * 4)
    # 96 m of 200 m: 0.48 of the route, so that one of four sections was left, and nine of twenty.
    unfinished = ego(200.0, TerminalEvent.TIME_LIMIT)
    assert pace_ratios(unfinished, 4) == pytest.approx([0.8])
    assert len(pace_ratios(unfinished, 20)) == 9


@pytest.mark.parametrize(("share", "sections"), [(0.94, 3), (0.96, 4)])
def test_the_last_section_counts_from_95_per_cent_on(share: float, sections: int) -> None:
    assert len(slow_sections(ego(96.0 / share))) == sections


def test_sections_are_compared_one_by_one() -> None:
    # 48 m at 12 m/s (4 s), then 48 m at 6 m/s (8 s), beside one that keeps 8 m/s.
    motion = at_speeds([12.0] * 80 + [6.0] * 161)
    view = view_of(ego_on_road(motion, 96.0), beside(8.0))
    assert pace_ratios(view, 4) == pytest.approx([1.5, 1.5, 0.75, 0.75], rel=0.02)
    assert slow_sections(view) == pytest.approx((0.75, 0.75), rel=0.02)
    assert efficiency(view) == pytest.approx(112.5, rel=0.01)


def test_traffic_is_the_mean_of_the_moments_means_while_there_is_some() -> None:
    # Beside one at 10 m/s; for the first half of the time a second one at 4 m/s: means of 7, then
    # 10 m/s. The first section takes 3 s: half of the route is 6 s.
    first = np.arange(STEPS) < 120
    view = view_of(
        ego_on_road(straight(8.0, STEPS), 96.0),
        beside(10.0, "fast"),
        beside(4.0, "slow", present=first),
    )
    assert pace_ratios(view, 2) == pytest.approx([8.0 / 7.0, 8.0 / 10.0], rel=1e-3)
    # The ego's own speed counts only while somebody is there: here while it drives at 4 m/s.
    motion = at_speeds([4.0] * 120 + [12.0] * 121)
    alone_later = view_of(ego_on_road(motion, 96.0), beside(8.0, present=first))
    assert pace_ratios(alone_later, 1) == pytest.approx([0.5], rel=0.01)


@pytest.mark.parametrize(
    "other",
    [
        beside(0.05),  # stands
        SyntheticActor(motion=Motion.steady(0.0, 51.0, steps=STEPS, speed=9.0)),  # too far
        SyntheticActor(motion=straight(9.0, STEPS, y=3.5), role=Role.NPC_WALKER),
    ],
    ids=["standing", "far", "walker"],
)
def test_without_traffic_there_is_no_pace(other: SyntheticActor) -> None:
    view = view_of(ego_on_road(straight(8.0, STEPS), 96.0), other)
    assert len(pace_ratios(view, 1)) == 0
    assert slow_sections(view) == ()
    assert efficiency(view) is None


def test_sections_beyond_a_thousand_per_cent_are_left_out() -> None:
    # 0.3 m/s in the first half, 9 m/s in the second: 2,667 and 89 per cent.
    speeds = np.where(np.arange(STEPS) < 120, 0.3, 9.0)
    motion = Motion.along(np.cumsum(speeds) * 0.05 + 20.0, 3.5, yaw=0.0)
    view = view_of(ego_on_road(straight(8.0, STEPS), 96.0), SyntheticActor(motion=motion))
    assert efficiency(view) == pytest.approx(100.0 * 8.0 / 9.0, rel=0.02)


def test_efficiency_is_the_mean_of_twenty_sections() -> None:
    # The first 20 m of 400 m at 20 m/s, the others at 8 m/s, beside one at 8 m/s.
    steps = 20 + 951
    motion = at_speeds([20.0] * 20 + [8.0] * 951)
    other = SyntheticActor(motion=straight(8.0, steps, y=3.5))
    view = view_of(ego_on_road(motion, 400.0), other)
    assert efficiency(view) == pytest.approx(100.0 * (2.5 + 19.0) / 20.0, rel=5e-3)


def test_four_slow_sections_are_four_infractions() -> None:
    values = values_of(ego_on_road(straight(8.0, STEPS), 96.0), beside(10.0))
    assert values["driving_score_1_0"] == 100.0
    assert values["driving_score_2_0"] == pytest.approx(100.0 * 0.94**4)
    assert values["driving_score"] == pytest.approx(100.0 / (1.0 + 4 * 0.4 * 0.2))
    assert values["efficiency"] == pytest.approx(80.0)
