"""What the SMARTS policies are shown, what is made of their answers, and how they drive.

What needs the policies themselves runs where they are installed: ``DRIVORA_TEST_AGENTS`` names the
folder of agents.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drivora_service.agents.adapters.lights import light_speed
from drivora_service.agents.adapters.reference import find_reference
from drivora_service.agents.adapters.smarts_agents.acting import (
    allowed_speed,
    pose_of,
    step_towards,
    target_of,
)
from drivora_service.agents.adapters.smarts_agents.facing import make_facing
from drivora_service.agents.adapters.smarts_agents.lane_places import LanePlaces, lane_index
from drivora_service.agents.adapters.smarts_agents.observing import Observer, omit_ending_ways
from drivora_service.agents.adapters.smarts_agents.scene import (
    OFF_LANE,
    Scene,
    to_heading,
    to_yaw,
)
from drivora_service.agents.adapters.smarts_agents.ways import RouteWays
from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.agents.interface import (
    Agent,
    AgentContext,
    Control,
    Observation,
    PoseControl,
)
from drivora_service.agents.log import AgentLog
from drivora_service.agents.manifest import read_manifest
from drivora_service.agents.manifest_files import shipped_manifests
from drivora_service.agents.remote.adapter_messages import context_view
from drivora_service.agents.remote.remote_messages import setup_request
from drivora_service.agents.remote.views import (
    ContextView,
    LaneView,
    RouteView,
    VehicleView,
)
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.observations.trace import Light, TerminalEvent
from drivora_service.observations.trace_files.trace_hash import trace_sha256
from drivora_service.testing.agent_contract import AgentContract
from tests.agents.installed_agents import fresh_agent, installed_agents
from tests.agents.smarts_scenario import smarts_scenario
from tests.simulation.episodes import ego, place, run, scenario, standing, start

NAMES = ("smarts-iamp", "smarts-dsac", "smarts-casl")
DATA = Path(__file__).parent / "data" / "smarts_agents.npz"
CAR = VehicleView(
    model="car", length=4.8, width=1.9, wheelbase=2.8, mass=1500.0, max_acceleration=4.0,
    max_deceleration=8.0, max_steer=0.6, max_speed=50.0,
)  # fmt: skip


def lane(
    number: int, *points: tuple[float, float], after: tuple[int, ...] = (), left: int | None = None,
    right: int | None = None, junction: bool = False,
) -> LaneView:  # fmt: skip
    return LaneView(
        id=number, line=np.array(points, dtype=np.float64), width=3.0, speed_limit=10.0,
        successors=after, left=left, right=right, may_change_left=left is not None,
        may_change_right=right is not None, in_junction=junction,
    )  # fmt: skip


LANES = {
    view.id: view
    for view in (
        # Two lanes to the east; through a junction only the left one leads on, by 10.
        lane(1, (0.0, 0.0), (100.0, 0.0), left=2, after=(11,)),
        lane(2, (0.0, 3.0), (100.0, 3.0), right=1, after=(10,)),
        lane(10, (100.0, 3.0), (110.0, 3.0), junction=True, after=(3,)),
        lane(11, (100.0, 0.0), (110.0, -10.0), junction=True, after=(4,)),
        lane(3, (110.0, 3.0), (160.0, 3.0)),
        lane(4, (110.0, -10.0), (110.0, -60.0)),
    )
}


def context(goal: float = 160.0) -> ContextView:
    x = np.arange(0.0, goal + 1.0)
    ids = np.select([x < 100.0, x < 110.0], [2, 10], 3).astype(np.int64)
    route = RouteView(
        line=np.column_stack((x, np.full(len(x), 3.0))), arc=x, lanes=ids,
        speed_limits=np.full(len(x), 10.0), widths=np.full(len(x), 3.0), signals=(),
        runs=((2, 10, 3),),
    )  # fmt: skip
    return ContextView(
        ego_id="ego", vehicle=CAR, route=route, lanes=LANES, step_length=0.05, friction=1.0,
        seed=1, parameters={}, log=AgentLog(),
    )  # fmt: skip


def seen(
    x: float, y: float, *others: tuple[float, float, float, float], yaw: float = 0.0,
    speed: float = 8.0, light: Light = Light.NONE, distance: float = math.inf, time: float = 0.0,
) -> Observation:  # fmt: skip
    """The ego, and others as x, y, yaw and speed."""
    objects = np.zeros((len(others), 9))
    for row, (ox, oy, turn, fast) in enumerate(others):
        objects[row, :5] = ox, oy, turn, fast * math.cos(turn), fast * math.sin(turn)
    me = np.array([x, y, yaw, speed * math.cos(yaw), speed * math.sin(yaw), 0.5, 0.0, 0.1, 0.0])
    return Observation(
        time=time, ego=me, speed=speed, route_s=x, objects=objects, light=light,
        light_distance=distance, object_sizes=np.tile((4.0, 1.8), (len(others), 1)),
        object_kinds=np.zeros(len(others), dtype=np.int64), object_ids=np.arange(len(others)),
        speed_limit=10.0,
    )  # fmt: skip


def scene(observation: Observation) -> Scene:
    return Observer(context(), 45.0).observe(observation)


@given(st.floats(-20.0, 20.0))
def test_headings_go_from_north(yaw: float) -> None:
    heading = to_heading(yaw)
    assert -math.pi <= heading <= math.pi
    assert math.sin(to_yaw(heading) - yaw) == pytest.approx(0.0, abs=1e-9)
    assert (-math.sin(heading), math.cos(heading)) == pytest.approx((math.cos(yaw), math.sin(yaw)))


def test_only_lanes_that_lead_on_are_shown() -> None:
    shown = scene(seen(40.0, 0.4))
    (path,) = shown.waypoint_paths
    assert len(path) == 51
    places = np.array([point.pos for point in path])
    assert places == pytest.approx(np.column_stack((40.0 + np.arange(51), np.full(51, 3.0))))
    assert {point.lane_id for point in path} == {"2"}
    assert [point.lane_index for point in path[:2]] == [1, 1]
    assert path[7].lane_offset == pytest.approx(47.0)
    assert path[7].heading == pytest.approx(-math.pi / 2)
    # It drives in the other lane all the same.
    me = shown.ego_vehicle_state
    assert (me.lane_id, me.lane_index) == ("1", 0)
    assert (me.lane_position.s, me.lane_position.t) == pytest.approx((40.0, 0.4))


def test_a_way_goes_through_the_junction_and_beyond_the_end() -> None:
    (path,) = scene(seen(80.0, 3.0)).waypoint_paths
    ids = [point.lane_id for point in path]
    assert ids == ["2"] * 20 + ["10"] * 10 + ["3"] * 21
    shown = scene(seen(104.0, 2.0))
    assert shown.ego_vehicle_state.lane_id == "10"
    assert shown.ego_vehicle_state.lane_position.s == pytest.approx(4.0)
    assert shown.ego_vehicle_state.lane_position.t == pytest.approx(-1.0)
    (path,) = scene(seen(155.0, 3.0)).waypoint_paths
    assert path[-1].pos == pytest.approx((205.0, 3.0))
    assert {point.lane_id for point in path} == {"3"}


def test_the_goal_lies_ahead_on_the_route_and_not_behind_its_end() -> None:
    for x, goal in ((10.0, 55.0), (150.0, 160.0)):
        found = scene(seen(x, 3.0)).ego_vehicle_state.mission.goal.position
        assert found == pytest.approx((goal, 3.0, 0.0))


def test_others_are_shown_with_their_lanes_the_nearest_first() -> None:
    shown = scene(
        seen(40.0, 3.0, (70.0, 0.5, 0.0, 5.0), (50.0, 3.0, 0.0, 7.0), (45.0, 3.0, math.pi, 4.0),
             (95.0, 3.0, 0.0, 1.0))
    )  # fmt: skip
    others = shown.neighborhood_vehicle_states
    assert [other.id for other in others] == ["vehicle-2", "vehicle-1", "vehicle-0"]
    wrong, ahead, right = others
    # Against the direction of the lane that it is on: on none.
    assert (wrong.lane_id, wrong.lane_index) == (OFF_LANE, -1)
    assert (ahead.lane_id, ahead.lane_index) == ("2", 1)
    assert ahead.speed == pytest.approx(7.0)
    assert right.lane_id == "1"
    assert right.lane_position.t == pytest.approx(0.5)
    assert right.bounding_box.as_lwh == (4.0, 1.8, 1.5)


def test_a_run_is_counted_from_one() -> None:
    observer = Observer(context(), 45.0)
    shown = [observer.observe(seen(x, 3.0)) for x in (10.0, 10.8, 11.6)]
    assert [one.steps_completed for one in shown] == [1, 2, 3]
    assert [one.distance_travelled for one in shown] == pytest.approx([0.0, 0.8, 0.8])


def test_ways_that_are_about_to_end_are_left_out_unless_all_are() -> None:
    (path,) = scene(seen(40.0, 3.0)).waypoint_paths
    assert omit_ending_ways([path[:5], path]) == [path]
    assert omit_ending_ways([path[:5], path[:6]]) == [path[:6]]


def test_the_nearest_lane_in_the_direction_of_travel_is_found() -> None:
    places = LanePlaces(LANES)
    turning = places.find(np.array([103.0, -3.0]), -math.pi / 4)
    assert turning is not None
    assert turning.lane == 11
    assert turning.t == pytest.approx(0.0, abs=1e-9)
    assert places.find(np.array([50.0, 20.0]), 0.0) is None
    assert LanePlaces({}).find(np.zeros(2), 0.0) is None
    assert [lane_index(LANES, k) for k in (1, 2, 10)] == [0, 1, 0]


@settings(deadline=None, max_examples=30)
@given(st.floats(-3.1, 3.1), st.floats(-500.0, 500.0), st.floats(0.0, 900.0))
def test_a_turned_scene_does_not_depend_on_the_compass(
    turn: float, east: float, driven: float
) -> None:
    first = scene(seen(40.0, 2.0, (60.0, 3.0, 0.2, 5.0), yaw=0.1))
    other = replace(
        make_facing(first, 0.0), heading=turn, origin=np.array([east, 7.0])
    ).transform_scene(first)
    one, two = (make_facing(each, driven).transform_scene(each) for each in (first, other))
    for each in (one, two):
        assert each.ego_vehicle_state.heading == 0.0
        assert each.ego_vehicle_state.position[:2] == pytest.approx((0.0, driven), abs=1e-9)
    assert one.ego_vehicle_state.linear_velocity == pytest.approx((0.0, 8.0, 0.0))
    assert two.ego_vehicle_state.linear_velocity == pytest.approx((0.0, 8.0, 0.0))
    for a, b in zip(one.waypoint_paths[0], two.waypoint_paths[0], strict=True):
        assert a.pos == pytest.approx(b.pos, abs=1e-6)
        assert a.heading == pytest.approx(b.heading, abs=1e-6)
    (a_car,), (b_car,) = one.neighborhood_vehicle_states, two.neighborhood_vehicle_states
    assert a_car.position == pytest.approx(b_car.position, abs=1e-6)
    assert a_car.heading == pytest.approx(0.1, abs=1e-9)


@given(st.floats(-3.1, 3.1), st.floats(-50.0, 50.0), st.floats(-50.0, 50.0))
def test_a_pose_comes_back_into_the_plane(yaw: float, dx: float, dy: float) -> None:
    shown = scene(seen(40.0, 2.0, (40.0 + dx, 2.0 + dy, 0.0, 1.0), yaw=yaw))
    frame = make_facing(shown, 12.0)
    if not shown.neighborhood_vehicle_states:
        return
    (car,) = frame.transform_scene(shown).neighborhood_vehicle_states
    x, y, heading = frame.restore_pose(float(car.position[0]), float(car.position[1]), car.heading)
    assert (x, y) == pytest.approx((40.0 + dx, 2.0 + dy), abs=1e-9)
    assert heading == pytest.approx(-math.pi / 2, abs=1e-9)


def test_a_target_is_reached_in_two_steps_of_half_its_time() -> None:
    target = target_of(seen(40.0, 3.0, time=5.0), 41.0, 3.2, 0.1)
    first = step_towards(target, seen(40.0, 3.0, time=5.0), 0.05, math.inf)
    assert first[:3] == pytest.approx((40.5, 3.1, 0.05))
    second = step_towards(target, seen(40.5, 3.1, yaw=0.05, time=5.05), 0.05, math.inf)
    assert second[:3] == pytest.approx((41.0, 3.2, 0.1))


@pytest.mark.parametrize("step", [0.01, 0.04, 0.05, 0.1, 0.15, 0.2])
def test_steps_of_any_length_go_at_the_pace_of_the_target(step: float) -> None:
    target = target_of(seen(40.0, 3.0, yaw=3.1, time=5.0), 41.0, 3.2, -3.1)
    x, y, yaw, time = 40.0, 3.0, 3.1, 5.0
    while time < target.time + 0.1 - 1e-6:
        x, y, yaw, _ = step_towards(target, seen(x, y, yaw=yaw, time=time), step, math.inf)
        time += step
        assert x == pytest.approx(40.0 + 10.0 * (time - 5.0))
        assert y == pytest.approx(3.0 + 2.0 * (time - 5.0))
        assert yaw == pytest.approx(3.1 + 10.0 * (math.tau - 6.2) * (time - 5.0))


def test_no_policy_goes_faster_than_is_allowed() -> None:
    target = target_of(seen(40.0, 3.0, time=5.0), 42.0, 3.0, 0.4)
    pose = step_towards(target, seen(40.0, 3.0, time=5.0), 0.1, 5.0)
    assert pose[:3] == pytest.approx((40.5, 3.0, 0.1))
    assert step_towards(target, seen(40.0, 3.0, time=5.0), 0.1, 0.0)[:3] == (40.0, 3.0, 0.0)


def test_what_is_allowed_ends_before_a_red_light() -> None:
    where = context()
    reference = find_reference(where.route, where.lanes)
    assert allowed_speed(reference, seen(40.0, 3.0)) == pytest.approx(10.0)
    red = [
        allowed_speed(reference, seen(40.0, 3.0, speed=v, light=Light.RED, distance=d))
        for v, d in ((8.0, 40.0), (6.0, 10.0), (3.0, 3.0), (0.2, 0.4))
    ]
    assert red[0] == pytest.approx(10.0)
    assert red == sorted(red, reverse=True)
    assert red[-1] == 0.0


@pytest.mark.parametrize(
    ("light", "speed", "distance", "limited"),
    [
        (Light.GREEN, 10.0, 20.0, False),
        (Light.NONE, 10.0, math.inf, False),
        (Light.RED, 10.0, 20.0, True),
        (Light.RED, 10.0, 3.0, False),
        (Light.YELLOW, 10.0, 30.0, True),
        (Light.YELLOW, 10.0, 10.0, False),
    ],
)
def test_a_light_limits_the_speed_where_stopping_is_possible(
    light: Light, speed: float, distance: float, limited: bool
) -> None:
    found = light_speed(seen(0.0, 0.0, speed=speed, light=light, distance=distance))
    assert (found < math.inf) == limited
    if limited:
        assert found == pytest.approx(math.sqrt(5.0 * (distance - 0.5)))


def test_an_answer_may_be_of_any_kind_of_numbers() -> None:
    assert pose_of((np.float32(1.0), 2, np.array(3.0), 0.1)) == (1.0, 2.0, 3.0)


@pytest.fixture(scope="module")
def real_view() -> ContextView:
    """A way over two junctions of a shipped network, as an adapter is told of it."""

    class Told:
        def setup_env(self, context: AgentContext) -> None:
            self.view = context_view(setup_request(context, "run"), AgentLog())

        def run_step(self, observation: Observation) -> Control:
            return standing().run_step(observation)

    on = "signal-grid"
    told = Told()
    way = (place("grand_1_1", 30, on=on), place("grand_2_1", 60, on=on))
    start(scenario(ego(*way), on=on), told)
    return told.view


def test_real_roads_are_shown_along_the_whole_route(real_view: ContextView) -> None:
    view = real_view
    ways = RouteWays(view.lanes, view.route)
    stages = []
    for s, point in zip(view.route.arc[::5], view.route.line[::5], strict=True):
        stage = ways.stage(float(s))
        stages.append(stage)
        found = ways.ways(stage)
        # One of the ways passes here.
        assert min(abs(way.project(point)[1]) for way in found) < 0.2
        for one in found:
            assert np.hypot(*np.diff(one.line, axis=0).T).min() > 1e-4
            assert one.lanes[0] in view.lanes
    assert stages == sorted(stages)
    assert {stage % 2 for stage in stages} == {0, 1}
    assert len(ways.ways(0)) >= 1


def test_no_way_ahead_begins_behind_the_vehicle(real_view: ContextView) -> None:
    """A vehicle that stands would be sent back to where the way begins, and stand for good."""
    route = real_view.route
    ways = RouteWays(real_view.lanes, route)
    for s in np.arange(0.0, route.arc[-1] - 2.0, 0.1):
        here, ahead = (
            np.array([np.interp(at, route.arc, route.line[:, k]) for k in (0, 1)])
            for at in (s, s + 1.0)
        )
        behind = []
        for way in ways.ways(ways.stage(float(s))):
            first, aside = way.project(here)
            begin = [np.interp(first, way.arc, way.line[:, k]) for k in (0, 1)]
            if abs(aside) < 0.5:
                behind.append(float(np.dot(here - begin, ahead - here)))
        assert min(behind) < 0.1, s


def test_their_manifests_say_that_no_licence_is_stated() -> None:
    shipped = shipped_manifests()
    manifests = [read_manifest(shipped[name], name) for name in NAMES]
    assert all("none stated" in manifest.licence for manifest in manifests)
    assert all("lights" in manifest.description for manifest in manifests)
    assert {manifest.environment for manifest in manifests} == {"smarts-agents"}
    pinned = (manifests[0].folder / "requirements.txt").read_text()
    for package in NAMES:
        name = package.replace("smarts-", "smarts-agent-")
        assert f"{name}==" in pinned


@pytest.fixture(scope="module")
def installed() -> Iterator[AgentCatalogue]:
    with installed_agents(*NAMES) as catalogue:
        yield catalogue


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_they_answer_as_they_do_to_observations_of_smarts(
    installed: AgentCatalogue, name: str
) -> None:
    from tests.agents.data.make_smarts_reference import COLUMNS

    stored = np.load(DATA)
    wanted: FloatArray = stored[name.removeprefix("smarts-")]
    agent = fresh_agent(installed, name)
    start(smarts_scenario(seconds=14.0), agent)
    for k, pose in enumerate(wanted):
        count = int(stored["count"][k])
        numbers = dict(zip(COLUMNS, stored["numbers"][k].tolist(), strict=True))
        observation = Observation(
            time=numbers["time"], step=int(numbers["step"]), speed=numbers["speed"],
            acceleration=numbers["acceleration"], steer=numbers["steer"],
            route_s=numbers["route_s"], route_lateral=numbers["route_lateral"],
            light_distance=numbers["light_distance"], speed_limit=numbers["speed_limit"],
            ego=stored["ego"][k], objects=stored["objects"][k][:count],
            object_sizes=stored["sizes"][k][:count], object_ids=stored["ids"][k][:count],
            object_kinds=np.zeros(count, dtype=np.int64),
        )  # fmt: skip
        answer = agent.run_step(observation)
        assert isinstance(answer, PoseControl)
        assert answer[:3] == pytest.approx(pose.tolist(), abs=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_they_drive_the_same_way_twice(installed: AgentCatalogue, name: str) -> None:
    what = smarts_scenario(seconds=60.0, agent=name)
    traces = [run(what, fresh_agent(installed, name)) for _ in range(2)]
    assert [trace.ego_ends for trace in traces] == [(TerminalEvent.ARRIVED,)] * 2
    assert trace_sha256(traces[0]) == trace_sha256(traces[1])


@pytest.mark.slow
class TestSmartsIamp(AgentContract):
    @pytest.fixture(autouse=True)
    def _use(self, installed: AgentCatalogue) -> None:
        self.catalogue = installed

    def make_agent(self) -> Agent:
        return fresh_agent(self.catalogue, "smarts-iamp")
