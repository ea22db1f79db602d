from __future__ import annotations

import math
from itertools import pairwise
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.spatial import KDTree

from drivora_service.errors import NoRoute
from drivora_service.geometry.lines import arc_lengths
from drivora_service.networks.network_loading import load_network
from drivora_service.networks.projection import lane_positions_near
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.networks.routes.lane_route import LaneRoute
from drivora_service.networks.routes.routing import RoutePoint, check_way, match_route, plan_route


def at(network: RoadNetwork, lane: str, s: float, lateral: float = 0.0) -> RoutePoint:
    x, y, heading = network.lane(lane).position_at(s)
    return RoutePoint(
        x=x - lateral * math.sin(heading), y=y + lateral * math.cos(heading), yaw=heading
    )


def lane_ids(network: RoadNetwork, route: LaneRoute) -> list[list[str]]:
    return [[network.lanes[i].id for i in run.lanes] for run in route.runs]


def off_centre_lines(route: LaneRoute) -> NDArray[np.bool_]:
    """Tells which points of the reference line are between the centre lines of two runs."""
    lines = np.concatenate([run.line for run in route.runs])
    return np.asarray(KDTree(lines).query(route.line)[0]) > 0.6


def assert_sound(network: RoadNetwork, route: LaneRoute) -> None:
    """What every route promises, wherever it leads."""
    lanes = network.lanes
    for line, arc in [(route.line, route.arc), *((run.line, run.arc) for run in route.runs)]:
        assert arc == pytest.approx(arc_lengths(line))
        steps = np.diff(arc)
        assert (steps > 0.0).all()
        assert steps.max() <= 1.0 + 1e-9
    count = len(route.line)
    assert len(route.speed_limits) == len(route.point_lanes) == count
    assert [lanes[i].speed_limit for i in route.point_lanes] == route.speed_limits.tolist()

    headings = np.arctan2(*np.diff(route.line, axis=0).T[::-1])
    turns = np.abs((np.diff(headings) + np.pi) % (2.0 * np.pi) - np.pi)
    sharp = turns > math.radians(60.0)
    for point in route.line[1:-1][sharp]:
        # A lane of the network itself turns that sharply here.
        assert any(
            np.hypot(*(lane.shape - point).T).min() < 1.5
            for lane in lanes
            if lane.index in route.point_lanes
        )

    for run in route.runs:
        assert 0.0 <= run.start_s <= run.change_from <= run.end_s <= run.arc[-1] + 1e-9
        assert len(run.speed_limits) == len(run.arc)
        for lane, behind in pairwise(run.lanes):
            assert behind in {link.to_lane for link in lanes[lane].connections}
        assert all(lanes[i].drivable for i in run.lanes)
    for run, next_run in pairwise(route.runs):
        last, first = lanes[run.lanes[-1]], lanes[next_run.lanes[0]]
        assert first.index in (last.left, last.right)
        # The outer lane of a bend is longer than the one that was measured.
        assert run.end_s - run.change_from >= 6.0
    assert (route.point_lanes >= 0).all()
    assert {int(i) for i in route.point_lanes} <= {i for run in route.runs for i in run.lanes}

    off = off_centre_lines(route)
    if len(route.runs) == 1:
        assert not off.any()
    else:
        assert off.sum() <= 62 * (len(route.runs) - 1)
    assert list(route.signals) == sorted(route.signals, key=lambda signal: signal.s)
    for signal in route.signals:
        assert 0.0 <= signal.s <= route.length + 1e-9
        x, y = (np.interp(signal.s, route.arc, route.line[:, axis]) for axis in (0, 1))
        assert any(
            np.hypot(*(lanes[i].shape[-1] - (x, y))) < 1.0
            for i in route.runs[signal.run].lanes
            for link in lanes[i].connections
            if (link.traffic_light, link.link_index) == (signal.traffic_light, signal.link_index)
        )
    for edge, next_edge in pairwise(route.edges):
        assert any(
            network.lanes[i].edge_id == next_edge
            for lane in network.edge_lanes[edge]
            for i in _behind(network, lane)
        )


def _behind(network: RoadNetwork, lane: int) -> set[int]:
    """Returns the lanes behind a lane's end, through the junction's own lanes."""
    found: set[int] = set()
    for link in network.lanes[lane].connections:
        following = network.lanes[link.to_lane]
        if following.drivable and following.is_internal:
            found |= _behind(network, following.index)
        elif following.drivable:
            found.add(following.index)
    return found


def test_follows_a_lane_through_a_junction(loop: RoadNetwork) -> None:
    route = plan_route(loop, [at(loop, "a_1", 20.0, 0.3), at(loop, "c_0", 30.0)])
    assert_sound(loop, route)
    assert lane_ids(loop, route) == [["a_1", ":n1_0_0", "b_0", ":n2_0_0", "c_0"]]
    assert route.length == pytest.approx(210.0, abs=0.05)
    assert route.edges == ("a", "b", "c")
    assert route.line[0] == pytest.approx([20.0, 0.0])
    assert route.line[-1] == pytest.approx([230.0, 0.0], abs=0.01)
    (run,) = route.runs
    assert (run.start_s, run.end_s) == pytest.approx((20.0, 230.0), abs=0.05)
    assert run.change_from == run.end_s
    assert (run.line[0], run.line[-1]) == (
        pytest.approx([0.0, 0.0]),
        pytest.approx([260.0, 0.0]),
    )
    (signal,) = route.signals
    assert signal.s == pytest.approx(80.0, abs=0.05)
    assert (signal.traffic_light, signal.link_index, signal.run) == ("n1", 0, 0)
    limits = dict(zip(route.arc.round().astype(int), route.speed_limits, strict=True))
    assert (limits[10], limits[85], limits[100]) == (15.0, 10.0, 12.0)


def test_changes_lanes_where_the_route_needs_it(loop: RoadNetwork) -> None:
    """From the left lane of a to c, where only the right lanes lead."""
    route = plan_route(loop, [at(loop, "a_2", 20.0), at(loop, "c_0", 30.0)])
    assert_sound(loop, route)
    assert len(route.runs) == 2
    assert route.length == pytest.approx(210.0, abs=1.5)
    first, second = route.runs
    assert first.lanes[0] == loop.lane_by_id["a_2"]
    assert second.lanes[-1] == loop.lane_by_id["c_0"]
    assert route.line[0] == pytest.approx([20.0, 3.2])
    assert route.line[-1] == pytest.approx([230.0, 0.0], abs=0.01)
    aside = route.line[:, 1]
    assert (np.diff(aside) <= 1e-9).all()
    assert np.abs(np.diff(np.diff(aside))).max() < 0.05
    changing = route.line[(aside > 0.01) & (aside < 3.19)]
    assert 20.0 < changing[-1, 0] - changing[0, 0] <= 60.0


def test_two_internal_lanes_in_a_row(loop: RoadNetwork) -> None:
    route = plan_route(loop, [at(loop, "a_2", 50.0), at(loop, "b_1", 40.0)])
    assert_sound(loop, route)
    assert lane_ids(loop, route) == [["a_2", ":n1_1_0", ":n1_2_0", "b_1"]]
    assert route.length == pytest.approx(100.0)
    assert [signal.link_index for signal in route.signals] == [1]


@pytest.mark.parametrize("destination", [20.0, 19.5, 5.0])
def test_goes_around_to_its_start_or_behind_it(loop: RoadNetwork, destination: float) -> None:
    route = plan_route(loop, [at(loop, "a_1", 20.0), at(loop, "a_1", destination)])
    assert_sound(loop, route)
    assert route.edges == ("a", "b", "c", "d", "a")
    around = sum(float(loop.lane(i).arc[-1]) for i in ("a_1", ":n1_0_0", "b_0", "c_0", "d_0"))
    # The line cuts the corners of d by less than a metre each.
    assert route.length == pytest.approx(around + destination - 20.0, abs=3.0)


def test_passes_the_same_lane_twice(loop: RoadNetwork) -> None:
    route = plan_route(
        loop,
        [
            at(loop, "b_0", 10.0),
            at(loop, "c_0", 30.0),
            at(loop, "a_1", 50.0),
            at(loop, "c_0", 20.0),
        ],
    )
    assert_sound(loop, route)
    assert route.edges == ("b", "c", "d", "a", "b", "c")
    (signal,) = route.signals
    assert signal.s > 600.0


@pytest.mark.parametrize("repeated", [0.0, 0.4, -0.4])
def test_points_on_top_of_each_other_are_one(loop: RoadNetwork, repeated: float) -> None:
    route = plan_route(
        loop, [at(loop, "a_1", 20.0), at(loop, "a_1", 20.0 + repeated), at(loop, "a_1", 60.0)]
    )
    assert_sound(loop, route)
    assert route.length == pytest.approx(40.0, abs=1e-6)


def test_a_single_stretch_shorter_than_the_spacing(loop: RoadNetwork) -> None:
    route = plan_route(loop, [at(loop, "a_1", 20.0), at(loop, "a_1", 20.4)])
    assert route.length == pytest.approx(0.4)
    assert len(route.line) == 2


def test_start_at_the_end_of_a_lane(loop: RoadNetwork) -> None:
    route = plan_route(loop, [at(loop, "a_1", 100.0), at(loop, "b_0", 0.0)])
    assert_sound(loop, route)
    assert route.length == pytest.approx(10.0, abs=0.1)


def test_a_via_point_keeps_the_vehicle_in_its_lane(loop: RoadNetwork) -> None:
    places = [at(loop, "a_1", 5.0), at(loop, "a_2", 60.0), at(loop, "b_0", 80.0)]
    route = plan_route(loop, places)
    assert_sound(loop, route)
    assert len(route.runs) == 3
    assert np.hypot(*(route.line - (60.0, 3.2)).T).min() < 0.6


def test_no_change_where_there_is_no_room(loop: RoadNetwork) -> None:
    """4 m before the end of b's left lane nothing leads on, and the start is not moved."""
    with pytest.raises(NoRoute, match=r"destination 1 at .* cannot be reached from start 0"):
        plan_route(loop, [at(loop, "b_1", 86.0), at(loop, "c_0", 30.0)])


def test_says_which_point_cannot_be_reached(loop: RoadNetwork) -> None:
    points = [
        at(loop, "a_1", 5.0),
        at(loop, "b_0", 5.0),
        at(loop, "e_0", 10.0),
        at(loop, "c_0", 5.0),
    ]
    with pytest.raises(NoRoute, match=r"point 2 at \(210\.00, -40\.00\) cannot be reached from"):
        plan_route(loop, points)


@pytest.mark.parametrize("x", [math.nan, math.inf, 1e12, -100.0])
def test_says_which_point_is_off_the_network(loop: RoadNetwork, x: float) -> None:
    with pytest.raises(NoRoute, match="destination 1"):
        plan_route(loop, [at(loop, "a_1", 5.0), RoutePoint(x=x, y=0.0)])


def test_a_way_that_is_only_checked(loop: RoadNetwork) -> None:
    check_way(loop, [at(loop, "a_1", 5.0), at(loop, "a_1", 9.0)])
    with pytest.raises(NoRoute, match="destination 1"):
        check_way(loop, [at(loop, "b_1", 86.0), at(loop, "c_0", 30.0)])
    with pytest.raises(NoRoute, match="start and a destination"):
        check_way(loop, [at(loop, "a_1", 5.0)])


def test_needs_two_points(loop: RoadNetwork) -> None:
    with pytest.raises(NoRoute, match="a start and a destination"):
        plan_route(loop, [at(loop, "a_1", 5.0)])


def test_heading_chooses_the_side_of_the_road(town: RoadNetwork) -> None:
    """A point on the middle of a two-way road starts the way it faces."""
    asked = 0
    for lane in town.lanes:
        opposite = f"-{lane.edge_id}_0"
        if lane.is_internal or lane.arc[-1] < 40.0 or opposite not in town.lane_by_id:
            continue
        x, y, heading = lane.position_at(20.0)
        other = min(
            (p for p in lane_positions_near(town, x, y, max_distance=30.0)
             if town.lanes[p.lane].id == opposite),
            key=lambda p: abs(p.lateral),
            default=None,
        )  # fmt: skip
        if lane.lane_number != 0 or other is None or abs(other.lateral) > 5.0:
            continue
        towards = town.lanes[other.lane].position_at(other.s)
        middle = RoutePoint(x=(x + towards[0]) / 2, y=(y + towards[1]) / 2, yaw=heading)
        end = lane.position_at(float(lane.arc[-1]) - 5.0)
        route = plan_route(town, [middle, RoutePoint(x=end[0], y=end[1], yaw=end[2])])
        assert route.point_lanes[0] == lane.index
        asked += 1
    assert asked > 5


SHARE = st.floats(0.0, 0.999)
PLACES = st.lists(st.tuples(SHARE, SHARE, st.floats(-0.5, 0.5)), min_size=2, max_size=4)
"""Places on any network: which of its lanes, how far along it, metres beside it."""


def assert_route_is_sound(network: RoadNetwork, places: list[tuple[float, float, float]]) -> None:
    lanes = [lane for lane in network.lanes if lane.drivable and lane.arc[-1] > 1.0]
    ends = []
    for which, share, lateral in places:
        lane = lanes[int(which * len(lanes))]
        ends.append(at(network, lane.id, share * float(lane.arc[-1]), lateral))
    try:
        route = plan_route(network, ends)
    except NoRoute:
        return
    assert_sound(network, route)
    # A destination up to a metre behind the place before it is reached there, and one that only a
    # lap leads to in another lane of its edge.
    for end, reached, reach, apart in (
        (ends[0], route.line[0], 6.0, 0.1),
        (ends[-1], route.line[-1], 20.0, 1.1),
    ):
        near = lane_positions_near(network, end.x, end.y, max_distance=reach)
        feet = [network.lanes[p.lane].position_at(p.s)[:2] for p in near]
        assert min(math.dist(foot, reached) for foot in feet) < apart


def test_any_route_on_a_real_town_is_sound(town: RoadNetwork) -> None:
    assert_any_route_is_sound(town)


def test_any_route_on_a_shipped_network_is_sound(shipped_network: RoadNetwork) -> None:
    assert_any_route_is_sound(shipped_network)


def assert_any_route_is_sound(network: RoadNetwork) -> None:
    # The network is no argument of the property: Hypothesis would print all of it.
    @settings(max_examples=30, deadline=None)
    @example(places=[(0.0, 0.5, 0.0), (0.0, 0.0, 0.0)])  # behind the start, in a junction
    @given(places=PLACES)
    def property_holds(places: list[tuple[float, float, float]]) -> None:
        assert_route_is_sound(network, places)

    property_holds()


def test_a_route_that_goes_nowhere_is_sound_or_refused(shipped_network: RoadNetwork) -> None:
    assert_route_is_sound(
        shipped_network, [(0.375, 0.375, 0.0), (0.375, 0.3125, 0.0), (0.375, 0.375, 0.0)]
    )


def test_a_change_to_the_lane_beside_the_start_begins_at_the_start(
    shipped_network: RoadNetwork,
) -> None:
    # Two lanes of a bend, whose lengths differ, at half of each; then a place far away.
    assert_route_is_sound(
        shipped_network, [(0.68359375, 0.5, 0.0), (0.6875, 0.5, 0.0), (0.0, 0.0, 0.0)]
    )


def leaderboard_routes(folder: Path) -> list[tuple[str, str, list[tuple[float, ...]]]]:
    """Reads (id, town, [(x, y, yaw)]) in CARLA's frame, degrees."""
    return [
        (
            route.attrib["id"],
            route.attrib["town"],
            [
                tuple(float(waypoint.attrib[key]) for key in ("x", "y", "yaw"))
                for waypoint in route.iter("waypoint")
            ],
        )
        for path in sorted(folder.glob("leaderboard1_*.xml"))
        for route in ElementTree.parse(path).getroot()
    ]


def test_leaderboard_routes(shared_data: Path) -> None:
    routes = leaderboard_routes(shared_data / "routes")
    assert len(routes) == 36
    networks = {
        name: load_network(shared_data / "maps" / f"{name}.net.xml", name)
        for name in {town for _, town, _ in routes}
    }
    for number, town, waypoints in routes:
        network = networks[town]
        east, north = network.net_offset
        points = [
            RoutePoint(x=x + east, y=-y + north, yaw=-math.radians(yaw)) for x, y, yaw in waypoints
        ]
        route = plan_route(network, points)
        assert_sound(network, route)
        direct = sum(math.hypot(b.x - a.x, b.y - a.y) for a, b in pairwise(points))
        assert 0.99 * direct < route.length
        assert route.length <= 1.15 * direct
        left_out = match_route(network, points).left_out
        assert left_out == LEFT_OUT.get((town, number), ())
        kept = [p for index, p in enumerate(points) if index not in left_out]
        passed = [np.hypot(*(route.line - (p.x, p.y)).T).min() for p in kept]
        assert max(passed) < 4.0
        assert passed[0] < 0.5
        assert passed[-1] < 2.0


LEFT_OUT = {("Town04", "11"): (36, 37), ("Town04", "32"): (7, 8), ("Town04", "35"): (30,)}
"""Waypoints of the routes that no vehicle can pass on its way: 11 ends with a left turn that the
network does not have, 32 has two points that face against their lanes, 35 one beside every road."""
