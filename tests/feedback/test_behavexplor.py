"""The degree of violation, term by term, and the ego that is described."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

from drivora_service.errors import SearchError
from drivora_service.feedback.behavexplor import DEGREE, WINDOWS
from drivora_service.feedback.catalogue import FeedbackCatalogue
from drivora_service.feedback.measurement import FeedbackChoice, Measurement
from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import TerminalEvent, Trace
from drivora_service.testing.networks import CROSSING, EAST, EAST_LEFT, straight_road
from drivora_service.testing.oracle_contract import example_runs
from drivora_service.testing.traces import Motion, SyntheticActor, SyntheticEgo, make_trace

ROAD = straight_road()
STEPS = 200
FAR = {"line_scale": 0.01, "edge_scale": 0.01}
"""Scales by which an ego that keeps to its lane scores 1 for all borders."""


def ego(**fields: Any) -> SyntheticEgo:
    """An ego in the middle of the right one of two lanes that arrives."""
    defaults: dict[str, Any] = {
        "motion": Motion.steady(0.0, 0.0, steps=STEPS, speed=5.0),
        "lane": EAST,
        "lane_lateral": 0.0,
        "lane_heading": 0.0,
        "route": np.array([(0.0, 0.0), (100.0, 0.0)]),
        "end": TerminalEvent.ARRIVED,
    }
    return SyntheticEgo(**{**defaults, **fields})


def measured(trace: Trace, **parameters: float) -> Measurement:
    choice = FeedbackChoice(name="behavexplor", parameters=parameters)
    return FeedbackCatalogue().create(choice).measure(RunView(trace, ROAD))


def degree(*egos: SyntheticEgo, at: tuple[float, float] | None = None, **scales: float) -> float:
    others = []
    if at is not None:
        others = [SyntheticActor(motion=Motion.steady(*at, steps=STEPS))]
    found = measured(make_trace(egos, others), **{**FAR, **scales}).objectives[DEGREE]
    assert found is not None
    return found


def test_what_arrives_alone_and_in_its_lane_is_farthest_from_a_failure() -> None:
    assert degree(ego()) == 1.0


@pytest.mark.parametrize(("end", "term"), [(97.75, 1.0), (90.75, 0.3), (87.75, 0.0), (40.0, 0.0)])
def test_ending_farther_from_the_destination_is_nearer_to_a_failure(
    end: float, term: float
) -> None:
    # The front is 2.25 m ahead of the centre, and the destination at 100 m.
    motion = Motion.along(np.linspace(0.0, end, STEPS), 0.0)
    late = ego(motion=motion, end=TerminalEvent.TIME_LIMIT)
    assert degree(late) == pytest.approx((3.0 + term) / 4.0)


def test_a_destination_beside_the_box_is_as_far_as_its_side() -> None:
    motion = Motion.along(np.linspace(0.0, 100.0, STEPS), 5.9)
    assert degree(ego(motion=motion, end=TerminalEvent.STUCK)) == pytest.approx((3.0 + 0.5) / 4.0)


@pytest.mark.parametrize(("side", "term"), [(1.8, 0.0), (2.3, 0.5), (2.8, 1.0), (9.0, 1.0)])
def test_the_least_distance_to_the_others(side: float, term: float) -> None:
    assert degree(ego(), at=(30.0, side)) == pytest.approx((3.0 + term) / 4.0)


@pytest.mark.parametrize(
    ("lane", "lateral", "line", "edge"),
    [
        (EAST, 0.0, 1.0, 0.85),
        (EAST, -0.65, 1.0, 0.2),
        (EAST, -1.5, 1.0, 0.0),
        (EAST_LEFT, 0.0, 0.85, 1.0),
        (EAST_LEFT, 0.65, 0.2, 1.0),
        (EAST, 1.75, 1.0, 1.0),
    ],
)
def test_the_line_to_the_left_and_the_edge_to_the_right(
    lane: int, lateral: float, line: float, edge: float
) -> None:
    y = (0.0 if lane == EAST else 3.5) + lateral
    driven = ego(
        motion=Motion.steady(0.0, y, steps=STEPS, speed=5.0), lane=lane, lane_lateral=lateral
    )
    expected = (2.0 + line + edge) / 4.0
    assert degree(driven, line_scale=1.0, edge_scale=1.0) == pytest.approx(expected)


def test_one_moment_at_a_border_counts() -> None:
    lateral = np.zeros(STEPS)
    lateral[50] = -0.85
    found = degree(ego(lane_lateral=lateral), edge_scale=1.0)
    assert found == pytest.approx(3.0 / 4.0)


def test_a_box_that_stands_askew_reaches_further() -> None:
    askew = ego(motion=Motion.steady(0.0, 0.0, steps=STEPS, yaw=0.2))
    assert degree(askew, edge_scale=1.0) < degree(ego(), edge_scale=1.0)


def test_there_are_no_lines_inside_a_junction() -> None:
    motion = Motion.steady(505.0, 0.0, steps=STEPS, speed=0.5)
    assert degree(ego(motion=motion, lane=CROSSING), line_scale=9.0, edge_scale=9.0) == 1.0


def test_leaving_the_road_is_reaching_its_edge() -> None:
    motion = Motion.steady(0.0, -8.0, steps=STEPS, speed=5.0)
    off = ego(motion=motion, lane=-1, lane_lateral=np.nan, lane_heading=np.nan)
    assert degree(off) == pytest.approx(3.0 / 4.0)


def test_of_several_egos_the_one_nearest_to_a_failure_counts() -> None:
    fine = ego(id="fine", motion=Motion.steady(0.0, 3.5, steps=STEPS, speed=8.0), lane=EAST_LEFT)
    late = ego(id="late", motion=Motion.steady(50.0, 0.0, steps=STEPS), end=TerminalEvent.STUCK)
    both = measured(make_trace([fine, late]), **FAR)
    assert both.objectives[DEGREE] == pytest.approx(3.0 / 4.0)
    # The other one is still seen, and so is the gap between the two; but the table is of one.
    assert both.features[WINDOWS] == measured(make_trace([late]), **FAR).features[WINDOWS]
    assert both.features[WINDOWS] != measured(make_trace([fine]), **FAR).features[WINDOWS]


def test_of_equal_egos_the_first_counts() -> None:
    one = ego(id="one", motion=Motion.steady(0.0, 3.5, steps=STEPS, speed=8.0), lane=EAST_LEFT)
    other = ego(id="other", motion=Motion.steady(200.0, 0.0, steps=STEPS, speed=5.0))
    both = measured(make_trace([one, other]), **FAR)
    assert both.objectives[DEGREE] == 1.0
    assert both.features[WINDOWS] == measured(make_trace([one]), **FAR).features[WINDOWS]


def test_an_ego_that_never_started_has_neither() -> None:
    found = measured(make_trace([ego(start_time=100.0)]))
    assert found.objectives == {DEGREE: None}
    assert found.features == {WINDOWS: ()}


def test_an_ego_that_never_started_does_not_hide_another() -> None:
    absent = ego(id="absent", motion=Motion.steady(300.0, 3.5, steps=STEPS), start_time=100.0)
    found = measured(make_trace([absent, ego(id="there")]), **FAR)
    assert found.objectives[DEGREE] == 1.0
    assert len(found.features[WINDOWS]) == 10


def test_windows_and_strides_are_in_seconds() -> None:
    trace = make_trace([ego()])
    assert len(measured(trace).features[WINDOWS]) == 10
    assert len(measured(trace, window=2.0, stride=2.0).features[WINDOWS]) == 5
    assert len(measured(trace, stride=0.1).features[WINDOWS]) == 91


@pytest.mark.parametrize("trace", example_runs())
def test_measurements_are_shares_and_finite_tables(trace: Trace) -> None:
    found = measured(trace)
    value = found.objectives[DEGREE]
    assert value is None or 0.0 <= value <= 1.0
    rows = found.features[WINDOWS]
    assert {len(row) for row in rows} <= {64}
    json.dumps(rows, allow_nan=False)


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"window": 0.2}, "fewer than 3 samples"),
        ({"stride": 1.5}, "gaps"),
        ({"gap_scale": 0.0}, "gap_scale"),
        ({"scale": 1.0}, "no parameter 'scale'"),
    ],
)
def test_unusable_parameters_are_refused(parameters: dict[str, float], message: str) -> None:
    with pytest.raises(SearchError, match=message):
        measured(make_trace([ego()]), **parameters)
