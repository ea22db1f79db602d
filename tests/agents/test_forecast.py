"""Where adapters foresee others: along their lanes, on braking until they stand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from drivora_service.agents.adapters.forecast import LaneForecaster
from drivora_service.agents.interface import Observation
from drivora_service.agents.remote.views import LaneView
from drivora_service.observations.trace import Col

TIMES = np.arange(0.0, 5.01, 0.5)
BEND = 20.0


def lane(number: int, line: list[tuple[float, float]], *successors: int) -> LaneView:
    return LaneView(
        id=number,
        line=np.array(line),
        width=3.2,
        speed_limit=14.0,
        successors=successors,
        left=None,
        right=None,
        may_change_left=False,
        may_change_right=False,
        in_junction=False,
    )


ARC = [
    (40.0 + BEND * math.sin(a), BEND * (1.0 - math.cos(a)))
    for a in np.linspace(0.0, 0.5 * math.pi, 30).tolist()
]
LANES = {1: lane(1, [(0.0, 0.0), (40.0, 0.0)], 2), 2: lane(2, ARC)}


def seen(x: float, y: float, speed: float, *, braking: float = 0.0, kind: int = 0) -> Observation:
    state = np.zeros((1, len(Col)))
    state[0, [Col.X, Col.Y, Col.VX, Col.AX]] = x, y, speed, -braking
    return Observation(
        ego=np.zeros(len(Col)),
        objects=state,
        object_sizes=np.array([[4.5, 1.9]]),
        object_kinds=np.array([kind]),
        object_ids=np.array([7]),
    )


def test_a_vehicle_follows_its_lane_round_a_bend() -> None:
    forecast = LaneForecaster(LANES).foresee(seen(20.0, 0.5, 10.0), TIMES, 5)
    assert forecast.ids.tolist() == [7]
    path = forecast.poses[0]
    np.testing.assert_allclose(path[0], [20.0, 0.5, 0.0], atol=1e-9)
    # Half a metre left of the lane is inside of a bend to the left.
    radius = np.hypot(path[5:, 0] - 40.0, path[5:, 1] - BEND)
    np.testing.assert_allclose(radius[:5], BEND - 0.5, atol=0.1)
    assert path[-1, 2] > 1.2


def test_a_walker_goes_straight_on() -> None:
    forecast = LaneForecaster(LANES).foresee(seen(30.0, 0.0, 4.0, kind=1), TIMES, 5)
    np.testing.assert_allclose(forecast.poses[0, -1, :2], [50.0, 0.0])


def test_who_brakes_stands_in_the_end() -> None:
    forecast = LaneForecaster(LANES).foresee(seen(5.0, 0.0, 8.0, braking=4.0), TIMES, 5)
    assert forecast.poses[0, -1, 0] == pytest.approx(5.0 + 8.0**2 / (2 * 4.0))


def test_no_more_than_asked_for_are_foreseen_the_nearest_first() -> None:
    near, far = seen(10.0, 0.0, 5.0), seen(30.0, 0.0, 5.0)
    both = Observation(
        ego=near.ego,
        objects=np.concatenate((far.objects, near.objects)),
        object_sizes=np.concatenate((far.object_sizes, near.object_sizes)),
        object_kinds=np.array([0, 0]),
        object_ids=np.array([1, 2]),
    )
    assert LaneForecaster(LANES).foresee(both, TIMES, 1).ids.tolist() == [2]
