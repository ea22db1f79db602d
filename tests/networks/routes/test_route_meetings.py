"""Where routes meet in junctions."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from numpy.typing import NDArray

from drivora_service.geometry.lines import arc_lengths
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.networks.right_of_way import Movement, right_of_way
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.networks.routes.route_meetings import find_meetings, meeting_matrix
from drivora_service.testing.networks import straight_road

Line = NDArray[np.float64]

SQUARE = np.array([(-10.0, -10.0), (10.0, -10.0), (10.0, 10.0), (-10.0, 10.0)])
CROSSING = replace(straight_road(), junction_shapes={"crossing": SQUARE})


def line(*points: tuple[float, float]) -> Line:
    """Draws straight pieces through points, at most 1 m apart."""
    corners = np.array(points)
    arc = arc_lengths(corners)
    at = np.linspace(0.0, arc[-1], int(arc[-1]) + 2)
    return np.column_stack((np.interp(at, arc, corners[:, 0]), np.interp(at, arc, corners[:, 1])))


EAST = line((-60.0, -1.6), (60.0, -1.6))
WEST = line((60.0, 1.6), (-60.0, 1.6))
NORTH = line((1.6, -60.0), (1.6, 60.0))
WEST_TO_NORTH = line((-60.0, -1.6), (-10.0, -1.6), (1.6, 10.0), (1.6, 60.0))


def test_crossing_routes_meet_where_they_cross() -> None:
    (meeting,) = find_meetings(CROSSING, [EAST, NORTH])
    assert (meeting.first, meeting.second) == (0, 1)
    (enter, leave), (other_enter, other_leave) = meeting.zones
    assert enter == pytest.approx(61.6 - 2.6, abs=1.0)
    assert leave == pytest.approx(61.6 + 2.6, abs=1.0)
    assert other_enter == pytest.approx(58.4 - 2.6, abs=1.0)
    assert other_leave == pytest.approx(58.4 + 2.6, abs=1.0)


def test_merging_routes_meet_as_far_as_the_junction_goes() -> None:
    (meeting,) = find_meetings(CROSSING, [WEST_TO_NORTH, NORTH])
    assert meeting.zones[1][1] == pytest.approx(70.0, abs=1.0)


@pytest.mark.parametrize(
    ("one", "other"),
    [
        pytest.param(EAST, WEST, id="side by side"),
        pytest.param(EAST, WEST_TO_NORTH, id="from the same lane"),
        pytest.param(EAST, EAST[30:], id="one behind the other"),
        pytest.param(EAST, NORTH[:45], id="one ends before the junction"),
        pytest.param(EAST, NORTH + np.array([30.0, 0.0]), id="crossing outside a junction"),
    ],
)
def test_who_does_not_come_together_in_a_junction_does_not_meet(one: Line, other: Line) -> None:
    assert find_meetings(CROSSING, [one, other]) == ()


def test_a_route_that_comes_back_meets_twice() -> None:
    around = line(
        (-60.0, -1.6), (60.0, -1.6), (60.0, -40.0), (40.0, -40.0), (40.0, 1.6), (-60.0, 1.6)
    )
    first, second = find_meetings(CROSSING, [around, NORTH])
    assert first.zones[0][1] < second.zones[0][0]


def test_the_matrix_has_the_routes_that_meet() -> None:
    meet = meeting_matrix(CROSSING, [EAST, WEST, NORTH, WEST_TO_NORTH])
    assert np.array_equal(meet, meet.T)
    pairs = {(int(i), int(j)) for i, j in np.argwhere(meet) if i < j}
    assert pairs == {(0, 2), (1, 2), (1, 3), (2, 3)}


def test_no_routes_meet_without_junctions_or_routes() -> None:
    assert find_meetings(straight_road(), [EAST, NORTH]) == ()
    assert find_meetings(CROSSING, []) == ()
    assert meeting_matrix(CROSSING, []).shape == (0, 0)


@pytest.mark.parametrize(
    ("name", "all_foes"),
    [("roundabout", True), ("tee-town", True), ("highway", True), ("signal-grid", False)],
)
def test_meeting_agrees_with_the_right_of_way(name: str, all_foes: bool) -> None:
    # Lanes side by side into one road are foes in the network's table where they may be changed
    # inside the junction; their centre lines do not meet.
    network = NetworkCatalogue(shipped_networks()).get(name)
    table = {movement.lanes: movement for movement in right_of_way(network).by_lane.values()}
    movements = [m for m in table.values() if m.incoming >= 0]
    meet = meeting_matrix(network, [way_of(network, movement) for movement in movements])
    met = 0
    for i, j in combinations(range(len(movements)), 2):
        one, other = movements[i], movements[j]
        if one.junction != other.junction or one.incoming == other.incoming:
            continue
        foes = other.lanes[-1] in one.foes or one.lanes[-1] in other.foes
        assert foes or not meet[i, j], (one, other)
        assert meet[i, j] or not (foes and all_foes), (one, other)
        met += bool(meet[i, j])
    assert met > 20


def way_of(network: RoadNetwork, movement: Movement) -> Line:
    """Returns the line of a movement with the lanes before and behind it."""
    behind = network.lanes[movement.lanes[-1]].connections[0].to_lane
    lanes = (movement.incoming, *movement.lanes, behind)
    points = np.concatenate([network.lanes[lane].shape for lane in lanes])
    apart = np.concatenate(([True], np.hypot(*np.diff(points, axis=0).T) > 1e-3))
    return line(*map(tuple, points[apart]))
