"""What the proposal planner foresees, how it scores, and what it drives."""

from __future__ import annotations

import math

import numpy as np
import pytest

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.agents.pdm_closed.forecast import STEP, STEPS, forecast
from drivora_service.agents.pdm_closed.margins import side_margins
from drivora_service.agents.pdm_closed.paths import LanePaths
from drivora_service.agents.pdm_closed.proposals import accelerate
from drivora_service.agents.pdm_closed.scoring import (
    first_collision,
    is_comfortable,
    keeps_time_to_collision,
    score,
)
from drivora_service.errors import AgentError
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.networks.routes.routing import RoutePoint, plan_route
from drivora_service.observations.trace import Col, EgoCol, TerminalEvent
from tests.simulation.episodes import car, ego, network, obstacle, place, run, scenario, track

HALF_LENGTH, HALF_WIDTH = 2.45, 0.92


def driven(speed: float, *, y: float = 0.0, pull: float = 0.0) -> FloatArray:
    """A proposal straight along the x axis."""
    path = np.zeros((STEPS + 1, 8))
    time = STEP * np.arange(STEPS + 1)
    path[:, 0] = path[:, 6] = speed * time
    path[:, 1] = path[:, 7] = y
    path[:, 3] = speed
    path[:, 4] = pull
    return path


def others(*states: tuple[float, float, float, float]) -> tuple[FloatArray, FloatArray]:
    """Forecasts and sizes of cars that keep x, y, heading and speed."""
    future = np.zeros((STEPS + 1, len(states), 4))
    for j, (x, y, yaw, speed) in enumerate(states):
        way = speed * STEP * np.arange(STEPS + 1)
        future[:, j, 0] = x + way * math.cos(yaw)
        future[:, j, 1] = y + way * math.sin(yaw)
        future[:, j, 2:] = (yaw, speed)
    return future, np.full((len(states), 2), (4.9, 1.84))


def strip() -> tuple[FloatArray, FloatArray]:
    """A straight way along the x axis, and 2 m of road on both sides of it."""
    x = np.arange(-10.0, 120.0)
    way = np.column_stack((x, np.zeros(len(x)), x, np.full(len(x), 10.0)))
    return way, np.tile((2.0, 2.0, 1.6), (len(x), 1))


def scores(*paths: FloatArray, future: FloatArray, sizes: FloatArray) -> FloatArray:
    way, margins = strip()
    out = np.zeros((len(paths), 5))
    score(
        np.stack(paths), 0.0, HALF_LENGTH, HALF_WIDTH, way, margins, future, sizes, out,
    )  # fmt: skip
    return out


def test_who_drives_into_something_that_stands_is_at_fault() -> None:
    future, sizes = others((30.0, 0.0, 0.0, 0.0))
    step = first_collision(driven(10.0), HALF_LENGTH, HALF_WIDTH, future, sizes)
    assert step * STEP == pytest.approx((30.0 - 2 * HALF_LENGTH) / 10.0, abs=0.15)


def test_who_is_run_into_from_behind_or_stands_is_not_at_fault() -> None:
    behind = others((-15.0, 0.0, 0.0, 20.0))
    assert first_collision(driven(5.0), HALF_LENGTH, HALF_WIDTH, *behind) == STEPS + 1
    crossing = others((0.0, -20.0, math.pi / 2, 10.0))
    assert first_collision(driven(0.0), HALF_LENGTH, HALF_WIDTH, *crossing) == STEPS + 1


def test_time_to_collision_is_kept_behind_a_leader_of_the_same_speed() -> None:
    same, slower = others((12.0, 0.0, 0.0, 10.0)), others((12.0, 0.0, 0.0, 3.0))
    assert keeps_time_to_collision(driven(10.0), HALF_LENGTH, HALF_WIDTH, *same)
    assert not keeps_time_to_collision(driven(10.0), HALF_LENGTH, HALF_WIDTH, *slower)


def test_comfort_ends_where_nuplan_says() -> None:
    assert is_comfortable(driven(10.0, pull=2.0), 2.0)
    assert not is_comfortable(driven(10.0, pull=2.5), 2.5)
    assert not is_comfortable(driven(10.0, pull=-4.2), -4.2)


def test_a_collision_and_the_edge_of_the_road_spoil_everything() -> None:
    future, sizes = others((40.0, 0.0, 0.0, 0.0))
    found = scores(driven(10.0), driven(5.0), future=future, sizes=sizes)
    assert found[0, 0] == 0.0
    assert found[0, 1] < math.inf
    assert found[1, 0] == pytest.approx(1.0)
    aside = driven(10.0)
    aside[10:, 7] = -1.5
    assert scores(aside, driven(5.0), future=future[:, :0], sizes=sizes[:0])[0, 0] == 0.0


def test_of_two_that_are_safe_the_one_that_gets_further_is_better() -> None:
    future, sizes = others()
    found = scores(driven(8.0), driven(4.0), future=future, sizes=sizes)
    assert found[:, 0] == pytest.approx((1.0, (2.5 + 5.0 + 2.0) / 12.0))


@pytest.mark.parametrize("wanted", [2.0, 5.0, 10.0])
def test_above_the_wanted_speed_it_brakes_no_harder_than_comfortably(wanted: float) -> None:
    assert -2.5 <= accelerate(15.0, wanted, math.inf, 0.0, 8.0) < 0.0
    assert accelerate(wanted, wanted, math.inf, 0.0, 8.0) == 0.0
    assert accelerate(15.0, 15.0, 4.0, 0.0, 8.0) == -8.0


def moving(lane: str, s: float, speed: float) -> FloatArray:
    where = place(lane, s)
    state = np.zeros((1, len(Col)))
    yaw = where.yaw or 0.0
    state[0, :3] = (where.x, where.y, yaw)
    state[0, Col.VX : Col.AX] = (speed * math.cos(yaw), speed * math.sin(yaw))
    return state


def foreseen(state: FloatArray, kind: int = 0) -> FloatArray:
    paths, ids = LanePaths(network()), np.array([7])
    future = np.empty((STEPS + 1, 1, 4))
    spans = paths.spans(0, state, np.array([kind]), ids)
    forecast(state, spans, paths.points, future)
    return future[:, 0]


def test_vehicles_are_foreseen_along_their_lane() -> None:
    lane = network().lane("harbour_1_0")
    future = foreseen(moving("harbour_1_0", 20.0, 10.0))
    ends = lane.position_at(20.0 + 10.0 * STEPS * STEP)
    assert future[-1, :2] == pytest.approx(ends[:2], abs=1.0)
    assert future[-1, 3] == 10.0


def test_who_brakes_is_foreseen_to_stop() -> None:
    state = moving("harbour_1_0", 20.0, 8.0)
    state[0, [Col.AX, Col.AY]] = -4.0 * state[0, [Col.VX, Col.VY]] / 8.0
    future = foreseen(state)
    assert future[-1, 3] == 0.0
    assert np.hypot(*(future[-1, :2] - future[0, :2])) == pytest.approx(8.0, abs=0.5)


def test_walkers_are_foreseen_straight_on() -> None:
    state = moving("harbour_1_0", 20.0, 1.5)
    state[0, Col.VX : Col.AX] = (0.9, 1.2)
    future = foreseen(state, kind=1)
    moved = future[-1, :2] - future[0, :2]
    assert moved == pytest.approx((0.9 * STEPS * STEP, 1.2 * STEPS * STEP))


def test_margins_end_at_the_edge_of_the_road() -> None:
    start, end = place("harbour_1_0", 20), place("harbour_1_0", 100)
    route = plan_route(network(), [RoutePoint(x=p.x, y=p.y, yaw=p.yaw) for p in (start, end)])
    width = network().lane("harbour_1_0").width
    margins = side_margins(network(), route.runs[0])
    middle = margins[int(np.searchsorted(route.runs[0].arc, 60.0))]
    assert middle[0] == math.inf
    assert middle[1] == pytest.approx(0.5 * width, abs=0.3)
    assert middle[2] == pytest.approx(0.5 * width)


@pytest.mark.parametrize("right", [1.7, 2.0])
def test_it_goes_round_a_car_that_partly_blocks_its_lane(right: float) -> None:
    what = scenario(
        ego(place("harbour_1_0", 10), place("harbour_1_0", 130), agent="pdm-closed"),
        npc_vehicles=(car(place("harbour_1_0", 70, right=right), behavior="replay"),),
        seconds=60.0,
    )
    trace = run(what)
    assert trace.ego_ends == (TerminalEvent.ARRIVED,)
    assert not trace.contacts


def test_it_waits_for_oncoming_traffic_before_it_goes_round() -> None:
    oncoming = tuple(
        car(
            place("-harbour_1_0", 5, speed=8.0), place("-harbour_0_0", 100, speed=8.0),
            name=f"oncoming{i}", start_time=3.0 * i,
        )
        for i in range(3)
    )  # fmt: skip
    what = scenario(
        ego(place("harbour_1_0", 10), place("harbour_1_0", 130), agent="pdm-closed"),
        npc_vehicles=(car(place("harbour_1_0", 70, right=1.6), behavior="replay"), *oncoming),
        seconds=60.0,
    )
    trace = run(what)
    assert not trace.contacts
    assert trace.ego_ends == (TerminalEvent.ARRIVED,)


def test_it_keeps_to_the_middle_of_a_free_lane() -> None:
    what = scenario(
        ego(place("harbour_1_0", 10), place("harbour_1_0", 130), agent="pdm-closed"), seconds=60.0
    )
    trace = run(what)
    lateral = trace.ego_values[:-1, 0, EgoCol.ROUTE_LATERAL]
    assert np.nanmax(np.abs(lateral)) < 0.2


def test_it_stops_for_a_barrel_in_the_middle() -> None:
    what = scenario(
        ego(place("harbour_1_0", 10), place("harbour_1_0", 130), agent="pdm-closed"),
        npc_obstacles=(obstacle(place("harbour_1_0", 70), model="static.prop.glasscontainer"),),
        seconds=30.0,
    )
    trace = run(what)
    assert not trace.contacts
    assert np.nanmax(np.hypot(*(track(trace, "ego")[-1:] - track(trace, "box")[-1:]).T)) > 3.0


@pytest.mark.parametrize("parameters", [{"offset": 5.0}, {"brake_within": -1.0}, {"horizon": 2}])
def test_parameters_out_of_their_limits_are_refused(parameters: dict[str, object]) -> None:
    with pytest.raises(AgentError, match="agent 'pdm-closed'"):
        AgentCatalogue().create("pdm-closed", parameters)
