"""When the overtaking intelligent driver changes lanes, and when it comes back."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.agents.idm_mobil.incentive import find_neighbours, incentive
from drivora_service.agents.idm_mobil.lane_ways import LaneWays, Place, Places
from drivora_service.agents.sumo_driver import SumoDriver
from drivora_service.networks.routes.lane_route import LaneRoute
from drivora_service.networks.routes.routing import RoutePoint, plan_route
from drivora_service.observations.trace import Col, EgoCol, TerminalEvent, Trace
from drivora_service.scenario.model import NpcVehicle, Scenario
from tests.simulation.episodes import car, ego, network, place, row_of, run, scenario, speeds, track

TOWN = "highway"
LORRY = "vehicle.carlamotors.european_hgv"
ALONE = np.array([math.inf, 0.0, math.inf, 0.0])


def lorry(lane: str, s: float, *to: tuple[str, float], speed: float) -> NpcVehicle:
    way = (place(lane, s, on=TOWN, speed=speed), *(place(*p, on=TOWN, speed=speed) for p in to))
    return NpcVehicle(id="lorry", model=LORRY, route=way)


def behind_a_lorry(agent: str, destination: tuple[str, float]) -> Scenario:
    return scenario(
        ego(
            place("eb_1_0", 20, on=TOWN), place(*destination, on=TOWN), agent=agent,
            initial_speed=22.0,
        ),
        on=TOWN, seconds=90.0,
        npc_vehicles=(lorry("eb_1_0", 80, ("eb_4_0", 400), speed=14.0),),
    )  # fmt: skip


def is_ahead(trace: Trace, other: str) -> bool:
    """Whether the ego has got further east than another, when its part ended."""
    last = int(np.flatnonzero(trace.present[:, row_of(trace, "ego")])[-1])
    return bool(track(trace, "ego")[last, 0] > track(trace, other)[last, 0])


def test_it_overtakes_a_slow_lorry_which_idm_does_not() -> None:
    ends = ("eb_2_0", 400.0)
    follows, overtakes = (run(behind_a_lorry(agent, ends)) for agent in ("idm", "idm-mobil"))
    assert follows.ego_ends == overtakes.ego_ends == (TerminalEvent.ARRIVED,)
    assert not overtakes.contacts
    assert not is_ahead(follows, "lorry")
    assert is_ahead(overtakes, "lorry")
    assert overtakes.times[-1] < follows.times[-1] - 5.0


def test_it_comes_back_for_its_exit() -> None:
    trace = run(behind_a_lorry("idm-mobil", ("eb_a_exit_ramp_0", 150.0)))
    assert trace.ego_ends == (TerminalEvent.ARRIVED,)
    assert not trace.contacts


def test_it_comes_back_to_the_right_when_it_has_overtaken() -> None:
    what = behind_a_lorry("idm-mobil", ("eb_2_0", 400.0))
    changes = [e.message for e in run(what).log_events if "lane" in e.message]
    assert len(changes) == 2


def test_without_a_reason_it_stays_in_its_lane() -> None:
    what = scenario(
        ego(place("eb_1_0", 20, on=TOWN), place("eb_2_0", 400, on=TOWN), agent="idm-mobil"),
        on=TOWN, seconds=90.0,
    )  # fmt: skip
    assert not run(what).log_events


def test_it_waits_for_those_who_come_from_behind() -> None:
    what = behind_a_lorry("idm-mobil", ("eb_2_0", 400.0))
    fast = tuple(
        car(
            place("eb_1_1", 60 - 25 * i, on=TOWN, speed=22.0),
            place("eb_2_1", 400, on=TOWN, speed=22.0), name=f"fast{i}",
        )
        for i in range(3)
    )  # fmt: skip
    trace = run(
        scenario(
            *what.ego_vehicles, on=TOWN, seconds=90.0, npc_vehicles=(*what.npc_vehicles, *fast)
        )
    )
    assert not trace.contacts
    for npc in fast:
        # They begin too near to one another, and brake for that.
        settled = speeds(trace, npc.id)[60:]
        assert -np.nanmin(np.diff(settled)) / trace.step_length < 2.0, npc.id


def test_it_ends_in_the_lane_of_its_destination() -> None:
    trace = run(behind_a_lorry("idm-mobil", ("eb_2_0", 400.0)))
    assert abs(trace.ego_values[trace.ego_values.shape[0] - 2, 0, EgoCol.ROUTE_LATERAL]) < 0.5


@pytest.mark.parametrize(
    "parameters", [{"politeness": 2.0}, {"threshold": -1}, {"bias": "left"}, {"patience": 1}]
)
def test_parameters_out_of_their_limits_are_refused(parameters: dict[str, object]) -> None:
    with pytest.raises(Exception, match="agent 'idm-mobil'"):
        AgentCatalogue().create("idm-mobil", parameters)


def test_a_high_threshold_keeps_it_in_its_lane() -> None:
    agent = AgentCatalogue().create("idm-mobil", {"threshold": 2.0, "bias": 2.0})
    assert not isinstance(agent, SumoDriver)
    trace = run(behind_a_lorry("idm", ("eb_2_0", 400.0)), agent)
    assert not is_ahead(trace, "lorry")


speed_values = st.floats(0.0, 40.0)
gaps = st.floats(1.0, 200.0)


@given(v=speed_values, wanted=st.floats(5.0, 40.0), gap=gaps, other=speed_values)
def test_the_same_lane_gains_nothing(v: float, wanted: float, gap: float, other: float) -> None:
    lane = np.array([gap, other, math.inf, 0.0])
    assert incentive(v, wanted, 5.0, lane, lane, 0.5, 9.5) == 0.0


@given(v=speed_values, wanted=st.floats(5.0, 40.0), gap=gaps, other=speed_values)
def test_a_free_lane_is_never_worse(v: float, wanted: float, gap: float, other: float) -> None:
    here = np.array([gap, other, math.inf, 0.0])
    assert incentive(v, wanted, 5.0, here, ALONE, 0.5, 4.0) >= 0.0


@given(gap=gaps, speed=speed_values, polite=st.floats(0.0, 1.0), ruder=st.floats(0.0, 1.0))
def test_politeness_weighs_what_the_one_behind_loses(
    gap: float, speed: float, polite: float, ruder: float
) -> None:
    polite, ruder = max(polite, ruder), min(polite, ruder)
    here = np.array([20.0, 5.0, math.inf, 0.0])
    there = np.array([math.inf, 0.0, gap, speed])
    gains = [incentive(15.0, 30.0, 5.0, here, there, p, 20.0) for p in (polite, ruder)]
    assert gains[0] <= gains[1] + 1e-12


def test_a_change_that_makes_the_one_behind_brake_hard_is_not_safe() -> None:
    here = np.array([20.0, 5.0, math.inf, 0.0])
    near = np.array([math.inf, 0.0, 5.0, 30.0])
    assert incentive(15.0, 30.0, 5.0, here, near, 0.2, 4.0) == -math.inf
    beside = np.array([math.inf, 0.0, -2.0, 15.0])
    assert incentive(15.0, 30.0, 5.0, here, beside, 0.2, 20.0) == -math.inf


def test_neighbours_are_found_ahead_and_behind_on_the_lane_only() -> None:
    line = np.column_stack((np.arange(-100.0, 101.0, 2.0), np.zeros(101), np.arange(0, 202, 2.0)))
    objects = np.zeros((4, len(Col)))
    objects[:, Col.X] = (30.0, 60.0, -20.0, 10.0)
    objects[:, Col.Y] = (0.2, 0.0, 0.0, 3.3)
    objects[:, Col.VX] = (7.0, 1.0, 9.0, 3.0)
    out = np.zeros(4)
    find_neighbours(line, 0.0, 0.0, 2.5, 1.0, objects, np.full((4, 2), (5.0, 2.0)), out)
    assert out == pytest.approx((25.0, 7.0, 15.0, 9.0))


def way(*points: tuple[str, float]) -> LaneRoute:
    places = [place(lane, s, on=TOWN) for lane, s in points]
    return plan_route(network(TOWN), [RoutePoint(x=p.x, y=p.y, yaw=p.yaw) for p in places])


def test_a_lane_that_does_not_lead_to_the_exit_must_be_left() -> None:
    net = network(TOWN)
    route = way(("eb_1_0", 20.0), ("eb_a_exit_ramp_0", 150.0))
    ways = LaneWays(net, route)
    right = Place(stage=0, lane=net.lane_by_id["eb_1_0"], s=20.0)
    left = ways.beside(right, left=True)
    assert left is not None
    assert left.lane == net.lane_by_id["eb_1_1"]
    assert ways.beside(right, left=False) is None
    metres, changes = ways.room(left)
    assert 300.0 < metres < 700.0
    assert changes == ways.room(right)[1] + 1


def test_the_way_from_beside_leads_to_the_same_place_along_the_same_edges() -> None:
    net = network(TOWN)
    route = way(("eb_1_0", 20.0), ("eb_a_exit_ramp_0", 150.0))
    ways = LaneWays(net, route)
    beside = ways.beside(Place(stage=0, lane=net.lane_by_id["eb_1_0"], s=20.0), left=True)
    assert beside is not None
    other = ways.route(beside)
    assert other.edges == route.edges
    assert other.line[-1] == pytest.approx(route.line[-1], abs=0.5)
    assert len(other.runs) > len(route.runs)
    start = net.lane("eb_1_1").position_at(beside.s)
    assert other.line[0] == pytest.approx(start[:2], abs=1.0)


def test_places_follow_the_runs_across_lane_changes() -> None:
    net = network(TOWN)
    route = way(("eb_1_2", 20.0), ("eb_a_exit_ramp_0", 150.0))
    places = Places(net, route, 0)
    for number, run_ in enumerate(route.runs):
        found = places.at(number, run_.start_s)
        assert found is not None
        assert net.lanes[found.lane].edge_id == route.edges[found.stage]
