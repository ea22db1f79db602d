"""The line along which planners sample: smooth, with speeds and room beside it."""

from __future__ import annotations

import numpy as np
import pytest

from drivora_service.agents.adapters.reference import find_reference
from drivora_service.agents.remote.views import LaneView, RouteView


def lane(number: int, y: float, *, left: int | None, right: int | None) -> LaneView:
    return LaneView(
        id=number,
        line=np.array([(0.0, y), (60.0, y)]),
        width=3.0,
        speed_limit=14.0,
        successors=(),
        left=left,
        right=right,
        may_change_left=True,
        may_change_right=True,
        in_junction=False,
    )


def route(line: np.ndarray[tuple[int, int], np.dtype[np.float64]], number: int) -> RouteView:
    steps = np.hypot(*np.diff(line, axis=0).T)
    return RouteView(
        line=line,
        arc=np.concatenate(([0.0], np.cumsum(steps))),
        speed_limits=np.full(len(line), 14.0),
        widths=np.full(len(line), 3.0),
        lanes=np.full(len(line), number),
        signals=(),
        runs=((number,),),
    )


def test_the_room_reaches_over_the_lanes_side_by_side() -> None:
    lanes = {
        1: lane(1, 0.0, left=2, right=None),
        2: lane(2, 3.0, left=3, right=1),
        3: lane(3, 6.0, left=None, right=2),
    }
    x = np.arange(0.0, 61.0)
    found = find_reference(route(np.column_stack((x, np.full(61, 3.5))), 2), lanes)
    # The way lies half a metre left of the middle lane's centre.
    assert found.left == pytest.approx(np.full(len(found.line), 4.0), abs=1e-6)
    assert found.right == pytest.approx(np.full(len(found.line), 5.0), abs=1e-6)
    assert found.arc[-1] > 60.0 + 50.0
    assert found.speeds == pytest.approx(np.full(len(found.line), 14.0))


def test_it_is_slow_in_a_corner_and_brakes_before() -> None:
    corner = np.concatenate(
        [
            np.column_stack((np.arange(0.0, 60.0), np.zeros(60))),
            np.column_stack((np.full(40, 60.0), np.arange(0.0, 40.0))),
        ]
    )
    found = find_reference(route(corner, 1), {1: lane(1, 0.0, left=None, right=None)})
    slowest = int(np.argmin(found.speeds))
    assert found.line[slowest] == pytest.approx([60.0, 0.0], abs=3.0)
    assert found.speeds[slowest] < 5.0
    lost = np.diff(found.speeds[: slowest + 1] ** 2) / (2.0 * np.diff(found.arc[: slowest + 1]))
    assert lost.min() >= -1.5 - 1e-6
