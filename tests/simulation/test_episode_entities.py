"""Every kind of entity of a document acts in an episode."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from drivora_service.agents.interface import AccelerationControl
from drivora_service.networks.projection import nearest_lane_position
from drivora_service.observations.trace import Col, EgoCol, Light, Role, TerminalEvent
from drivora_service.scenario.model import (
    BackgroundTraffic,
    EgoVehicle,
    LightTimes,
    MapRegion,
    Region,
    TrafficLights,
    Waypoint,
    Weather,
)
from drivora_service.simulation.sumo import SumoWorld
from tests.simulation.episodes import (
    Blind,
    Scripted,
    Watching,
    accelerating,
    car,
    closest,
    contacts,
    ego,
    network,
    obstacle,
    place,
    presence,
    row_of,
    run,
    scenario,
    speeds,
    standing,
    start,
    track,
    travelled,
    walker,
)

ROAD = "harbour_1_0"
"""126 m of tee-town, nearly straight, 50 km/h."""
AVENUE = "grand_1_1"
"""112 m of signal-grid with a sidewalk beside it, straight east, 50 km/h."""
WET = Weather(wetness=100.0, precipitation_deposits=100.0)


def parked(name: str = "ego") -> EgoVehicle:
    """An ego far from the roads that tests use."""
    return ego(place("-north_2_0", 20), place("-north_2_0", 100), name=name)


# --- egos ---


def test_an_ego_stands_until_its_start_time_and_drives_then() -> None:
    what = scenario(
        ego(place(ROAD, 10), place(ROAD, 110), name="now"),
        ego(place("-north_2_0", 10), place("-north_2_0", 120), name="later", start_time=2.0),
        ego(
            place("harbour_0_0", 20), place("harbour_0_0", 200), name="rolling",
            start_time=1.0, initial_speed=9.0,
        ),
        seconds=5.0,
    )  # fmt: skip
    trace = run(what)
    assert [a.role for a in trace.actors] == [Role.EGO] * 3
    assert presence(trace, "later").all()
    assert speeds(trace, "now")[40] > 1.0
    later = speeds(trace, "later")
    assert np.all(later[:41] == 0.0)
    assert np.all(track(trace, "later")[:41] == track(trace, "later")[0])
    assert later[80] > 1.0
    rolling = speeds(trace, "rolling")
    assert np.all(rolling[:20] == 0.0)
    assert 8.5 < rolling[21] < 9.5


# --- NPC vehicles ---


@pytest.mark.parametrize("behavior", ["replay", "reactive", "sumo"])
def test_an_npc_vehicle_comes_at_its_start_time_drives_its_route_and_leaves(behavior: str) -> None:
    npc = car(
        place(ROAD, 10, speed=8.0), place(ROAD, 60, speed=8.0), place(ROAD, 110, speed=8.0),
        behavior=behavior, start_time=1.0,
    )  # fmt: skip
    trace = run(scenario(parked(), npc_vehicles=(npc,), seconds=18.0), standing())
    here = presence(trace, "npc")
    first, last = int(np.argmax(here)), int(len(here) - 1 - np.argmax(here[::-1]))
    assert trace.times[first] == pytest.approx(1.0, abs=0.051)
    assert here[first : last + 1].all()
    assert trace.times[last] < 17.0
    way = track(trace, "npc")
    assert np.hypot(*(way[first] - (npc.route[0].x, npc.route[0].y))) < 1.0
    middle = np.hypot(*(way[first : last + 1] - (npc.route[1].x, npc.route[1].y)).T)
    assert middle.min() < 0.6
    assert np.hypot(*(way[last] - (npc.route[2].x, npc.route[2].y))) < 3.5
    assert np.nanmax(speeds(trace, "npc")) > 6.0


def test_a_replayed_vehicle_keeps_to_its_waypoints_off_the_road_and_to_their_speeds() -> None:
    route = tuple(Waypoint(x=150.0 + 10 * i, y=40.0 + 3 * i, speed=3.0 + i) for i in range(6))
    trace = run(
        scenario(parked(), npc_vehicles=(car(*route, behavior="replay"),), seconds=16.0),
        standing(),
    )
    way, speed = track(trace, "npc"), speeds(trace, "npc")
    for i, point in enumerate(route[1:-1], start=1):
        near = np.hypot(way[:, 0] - point.x, way[:, 1] - point.y)
        assert np.nanmin(near) < 0.5
        assert speed[int(np.nanargmin(near))] == pytest.approx(3.0 + i, abs=0.6)


def test_replay_drives_into_what_reactive_stops_for() -> None:
    block = obstacle(place(ROAD, 80))
    for behavior, reaches in (("replay", True), ("reactive", False), ("sumo", False)):
        npc = car(place(ROAD, 10, speed=8.0), place(ROAD, 120, speed=8.0), behavior=behavior)
        what = scenario(parked(), npc_vehicles=(npc,), npc_obstacles=(block,), seconds=12.0)
        assert (closest(run(what, standing()), "npc", "box") < 3.0) == reaches, behavior


def test_vehicles_of_every_behavior_stop_behind_a_standing_ego() -> None:
    for behavior in ("reactive", "sumo"):
        npc = car(place(ROAD, 10, speed=8.0), place(ROAD, 120, speed=8.0), behavior=behavior)
        what = scenario(ego(place(ROAD, 70), place(ROAD, 120)), npc_vehicles=(npc,), seconds=12.0)
        trace = run(what, standing())
        assert not trace.contacts
        assert speeds(trace, "npc")[-1] < 0.1
        assert 5.0 < closest(trace, "npc", "ego") < 12.0


def test_a_single_waypoint_is_a_parked_vehicle() -> None:
    trace = run(scenario(parked(), npc_vehicles=(car(place(ROAD, 50)),), seconds=2.0), standing())
    assert presence(trace, "npc").all()
    assert travelled(trace, "npc") == 0.0


# --- walkers ---


@pytest.mark.parametrize(("town", "lane"), [("tee-town", ROAD), ("signal-grid", AVENUE)])
def test_a_walker_walks_at_the_speeds_of_its_waypoints_and_stays(town: str, lane: str) -> None:
    route = (
        place(lane, 60, on=town, right=6.0),
        place(lane, 60, on=town, right=2.0, speed=1.0),
        place(lane, 60, on=town, right=-4.0, speed=2.0),
    )
    far = {"tee-town": "-north_2_0", "signal-grid": "north_3_1"}[town]
    what = scenario(
        ego(place(far, 20, on=town), place(far, 100, on=town)),
        on=town, npc_walkers=(walker(*route, start_time=1.0),), seconds=11.0,
    )  # fmt: skip
    trace = run(what, standing())
    here, speed = presence(trace, "walker"), speeds(trace, "walker")
    assert not here[:20].any()
    assert here[20:].all()
    assert speed[20 + 60] == pytest.approx(1.0, abs=0.05)
    assert speed[20 + 80 + 45] == pytest.approx(2.0, abs=0.05)
    assert speed[-1] == 0.0
    assert np.hypot(*(track(trace, "walker")[-1] - (route[2].x, route[2].y))) < 0.3
    assert trace.actors[row_of(trace, "walker")].length < 1.0


@pytest.mark.parametrize(("town", "lane"), [("tee-town", ROAD), ("signal-grid", "queen_1_1")])
@pytest.mark.parametrize("behavior", ["reactive", "sumo"])
def test_vehicles_stop_for_a_walker_in_their_lane_and_pass_one_beside_it(
    town: str, lane: str, behavior: str
) -> None:
    far = {"tee-town": "-north_2_0", "signal-grid": "north_3_1"}[town]
    npc = car(
        place(lane, 10, on=town, speed=8.0), place(lane, 105, on=town, speed=8.0),
        behavior=behavior,
    )  # fmt: skip
    for right, passes in ((0.0, False), (4.5, True)):
        what = scenario(
            ego(place(far, 20, on=town), place(far, 100, on=town)),
            on=town,
            npc_vehicles=(npc,),
            npc_walkers=(walker(place(lane, 70, on=town, right=right)),),
            seconds=11.0,
        )
        trace = run(what, standing())
        way = travelled(trace, "npc")
        assert (way > 65.0) if passes else (40.0 < way < 58.0), (right, way)


# --- obstacles ---


def test_an_obstacle_has_its_own_pose_size_and_start_time() -> None:
    spot = place(ROAD, 60)
    what = scenario(
        parked(),
        npc_obstacles=(
            obstacle(
                Waypoint(x=spot.x, y=spot.y, yaw=1.2), length=3.3, width=0.7, start_time=1.5,
            ),
            obstacle(place(ROAD, 90), name="plain", model="static.prop.trafficcone01"),
        ),
        seconds=3.0,
    )  # fmt: skip
    trace = run(what, standing())
    row = row_of(trace, "box")
    assert int(np.argmax(trace.present[:, row])) == 30
    assert trace.present[30:, row].all()
    assert np.all(trace.states[30:, row, :3] == (spot.x, spot.y, 1.2))
    assert np.all(trace.states[30:, row, 3:8] == 0.0)
    assert (trace.actors[row].length, trace.actors[row].width) == (3.3, 0.7)
    assert presence(trace, "plain").all()
    assert trace.actors[row_of(trace, "plain")].length < 1.0


def test_an_ego_hits_the_long_side_of_an_obstacle_that_reaches_into_its_lane() -> None:
    spot = place(ROAD, 70, right=4.0)
    across = (spot.yaw or 0.0) + 0.5 * math.pi
    for yaw, hits in ((spot.yaw, False), (across, True)):
        plank = obstacle(Waypoint(x=spot.x, y=spot.y, yaw=yaw), length=8.0, width=0.5)
        what = scenario(
            ego(place(ROAD, 10), place(ROAD, 120)), npc_obstacles=(plank,), seconds=15.0
        )
        assert bool(run(what, Blind()).contacts) == hits


# --- weather ---


def _braking_distance(weather: Weather) -> float:
    lane = "harbour_0_0"
    brake = Scripted(lambda o: AccelerationControl(-20.0 if o.time > 0.5 else 0.0, 0.0))
    what = scenario(
        ego(place(lane, 10), place(lane, 200), initial_speed=12.0), weather=weather, seconds=6.0
    )
    return travelled(run(what, brake), "ego")


def test_a_slippery_road_lengthens_the_braking_of_an_ego() -> None:
    assert _braking_distance(WET) > _braking_distance(Weather()) + 5.0


def _hardest_braking(behavior: str, weather: Weather) -> float:
    """m/s² of a vehicle before which a block appears at 4 s."""
    npc = car(place(ROAD, 5, speed=10.0), place(ROAD, 124, speed=10.0), behavior=behavior)
    free = scenario(parked(), npc_vehicles=(npc,), weather=weather, seconds=4.0)
    x, y = track(run(free, standing()), "npc")[-1]
    here = nearest_lane_position(network(), float(x), float(y))
    assert here is not None
    block = obstacle(place(ROAD, here.s + 19.0), start_time=4.0)
    blocked = replace(free, npc_obstacles=(block,), max_sim_time=8.0)
    return float(-np.nanmin(np.diff(speeds(run(blocked, standing()), "npc"))) / 0.05)


@pytest.mark.parametrize("behavior", ["reactive", "sumo"])
def test_a_slippery_road_weakens_the_braking_of_npcs(behavior: str) -> None:
    assert _hardest_braking(behavior, Weather()) > 4.4
    assert 1.5 < _hardest_braking(behavior, WET) <= 0.4 * 9.81 + 0.05


def test_fog_shortens_what_an_ego_perceives() -> None:
    cars = tuple(car(place(ROAD, s), name=f"at{s}") for s in (30, 60, 90, 120))
    seen = {}
    for density in (0.0, 100.0):
        eye = Watching()
        what = scenario(
            ego(place(ROAD, 10), place(ROAD, 22)), npc_vehicles=cars,
            weather=Weather(fog_density=density), seconds=0.5,
        )  # fmt: skip
        run(what, eye)
        seen[density] = [len(objects) for objects in eye.seen]
    assert set(seen[0.0]) == {4}
    assert max(seen[100.0]) == 2


def test_noise_and_drop_out_are_seeded() -> None:
    def watched(seed: int, weather: Weather) -> list[np.ndarray]:
        eye = Watching()
        what = scenario(
            ego(place(ROAD, 10), place(ROAD, 60)),
            npc_vehicles=tuple(car(place(ROAD, s), name=f"at{s}") for s in (25, 40)),
            weather=weather, seed=seed, seconds=5.0,
        )  # fmt: skip
        run(what, eye)
        return eye.seen

    fog = Weather(fog_density=100.0)
    first, again, other = watched(1, fog), watched(1, fog), watched(2, fog)
    assert all(np.array_equal(a, b) for a, b in zip(first, again, strict=True))
    assert any(not np.array_equal(a, b) for a, b in zip(first, other, strict=True))
    counts = np.array([len(objects) for objects in first])
    assert 0.05 < np.mean(counts < 2) < 0.6
    near = np.array([objects[0, 0] for objects in first if len(objects) == 2])
    assert 0.1 < near.std() < 0.8
    clear = watched(1, Weather())
    assert all(np.array_equal(a, clear[0]) for a in clear)


def test_egos_do_not_share_their_noise() -> None:
    eyes = (Watching(), Watching())
    what = scenario(
        ego(place(ROAD, 10), place(ROAD, 60), name="a"),
        ego(place("-harbour_1_0", 110), place("-harbour_1_0", 120), name="b"),
        npc_vehicles=(car(place(ROAD, 30)),), weather=Weather(fog_density=100.0), seconds=1.0,
    )  # fmt: skip
    run(what, *eyes)

    def errors(eye: Watching) -> list[float]:
        spot = place(ROAD, 30)
        return [float(o[:, 0][np.abs(o[:, 0] - spot.x) < 4.0].sum()) for o in eye.seen]

    assert errors(eyes[0]) != errors(eyes[1])


def test_wind_pushes_an_ego_off_its_line_but_not_one_that_stands() -> None:
    def drift(wind: float, initial_speed: float) -> float:
        what = scenario(
            ego(place("harbour_0_0", 10), place("harbour_0_0", 200), initial_speed=initial_speed),
            weather=Weather(wind_intensity=wind), seconds=4.0,
        )  # fmt: skip
        way = track(run(what, accelerating(0.0)), "ego")
        return float(way[-1, 1])

    assert drift(100.0, 10.0) > drift(0.0, 10.0) + 0.05
    assert drift(100.0, 0.0) == drift(0.0, 0.0)


# --- traffic lights ---


def test_light_times_of_a_document_are_shown_recorded_and_obeyed() -> None:
    lights = TrafficLights(times=LightTimes(green=6.0, yellow=2.0))
    what = scenario(
        ego(place(AVENUE, 60, on="signal-grid"), place("grand_2_1", 60, on="signal-grid")),
        on="signal-grid", traffic_lights=lights, seconds=45.0,
    )  # fmt: skip
    episode = start(what)
    shown = []
    while not episode.done:
        shown.append(episode._sumo.light_state("b2"))
        episode.step()
    trace = episode.finish()
    column = trace.light_ids.index("b2")
    recorded = [trace.light_state_names[i] for i in trace.light_states[:, column]]
    differ = [k for k, state in enumerate(shown) if state != recorded[k]]
    assert not differ, (differ[:3], len(differ))
    changes = np.flatnonzero(np.diff(trace.light_states[:, column])) + 1
    # Walkers have green for four fifths of the cars' six seconds; behind the yellow all is red.
    assert set(np.diff(trace.times[changes]).round(2)) == {4.8, 1.2, 2.0}
    assert trace.ego_ends[0] is TerminalEvent.ARRIVED
    distance = trace.ego_values[:, 0, EgoCol.LIGHT_DISTANCE]
    crossing = int(np.argmax(distance < 0.0))
    assert distance[crossing] < 0.0
    assert trace.ego_lights[crossing, 0] != Light.RED


def test_a_junctions_own_times_and_offset_count_for_it_alone() -> None:
    town = "signal-grid"
    own = TrafficLights(junctions={"b2": LightTimes(green=4.0, yellow=2.0, offset=3.0)})
    traces = [
        run(
            scenario(
                ego(place("north_3_1", 20, on=town), place("north_3_1", 90, on=town)),
                on=town, traffic_lights=lights, seconds=20.0,
            ),
            standing(),
        )
        for lights in (TrafficLights(), own)
    ]  # fmt: skip
    plain, changed = (
        {
            light: [trace.light_state_names[i] for i in trace.light_states[:, column]]
            for column, light in enumerate(trace.light_ids)
        }
        for trace in traces
    )
    assert {light for light in plain if plain[light] != changed[light]} == {"b2"}


# --- background traffic ---


def test_background_traffic_keeps_its_size_from_its_start_time_on() -> None:
    what = scenario(
        parked(), background_traffic=BackgroundTraffic(count=12, start_time=2.0), seconds=40.0
    )
    trace = run(what, standing())
    rows = [a.row for a in trace.actors if a.role is Role.BACKGROUND]
    count = trace.present[:, rows].sum(axis=1)
    assert np.all(count[:40] == 0)
    assert np.all(count[60:] >= 11)
    assert np.median(count[60:]) == 12
    moving = [travelled(trace, trace.actors[row].id) for row in rows]
    assert np.median(moving) > 50.0


def test_no_background_vehicle_enters_at_an_egos_start() -> None:
    spot = place(ROAD, 60)
    for seed in range(3):
        what = scenario(
            ego(spot, place(ROAD, 120)),
            background_traffic=BackgroundTraffic(count=60), seed=seed, seconds=0.3,
        )  # fmt: skip
        trace = run(what, standing())
        others = trace.states[1, 1:, :2]
        assert np.nanmin(np.hypot(*(others - (spot.x, spot.y)).T)) > 12.0
        assert not trace.contacts


def test_background_traffic_enters_inside_the_region_only() -> None:
    region = Region(min_x=-20.0, max_x=200.0, min_y=200.0, max_y=420.0)
    what = scenario(
        ego(place("-west_1_0", 20), place("-west_1_0", 100)),
        map_region=MapRegion(town="tee-town", region_segment=region),
        background_traffic=BackgroundTraffic(count=10), seconds=20.0,
    )  # fmt: skip
    trace = run(what, standing())
    entered = 0
    for actor in trace.actors[1:]:
        here = presence(trace, actor.id)
        first = np.flatnonzero(here & ~np.concatenate(([False], here[:-1])))
        for k in first:
            x, y = trace.states[k, actor.row, :2]
            # The front bumper enters inside; the centre is behind it.
            assert -23.0 < x < 203.0
            assert 197.0 < y < 423.0
            entered += 1
    assert entered >= 10


def test_background_traffic_stops_behind_a_standing_ego_and_the_ego_sees_it() -> None:
    eye = Watching()
    lane = network().lane(ROAD)
    what = scenario(
        ego(place(ROAD, 100), place(ROAD, 120)),
        background_traffic=BackgroundTraffic(count=50), seed=4, seconds=60.0,
    )  # fmt: skip
    trace = run(what, eye)
    assert not trace.contacts
    spot = np.array(lane.position_at(100.0)[:2])
    back = np.array(lane.position_at(80.0)[:2])
    queue = trace.states[-1, 1:]
    behind = np.hypot(*(queue[:, :2] - back).T) < 14.0
    heading = np.cos(queue[:, Col.YAW] - lane.position_at(80.0)[2]) > 0.9
    assert (behind & heading & (np.hypot(queue[:, Col.VX], queue[:, Col.VY]) < 0.1)).any()
    assert any(len(objects) for objects in eye.seen)
    nearest = min(np.hypot(*(o[:, :2] - spot).T).min() for o in eye.seen if len(o))
    assert nearest < 12.0


def test_a_reactive_vehicle_stops_behind_the_queue_of_others() -> None:
    what = scenario(
        ego(place(ROAD, 110), place(ROAD, 122)),
        npc_vehicles=(
            car(place(ROAD, 60, speed=8.0), place(ROAD, 120), name="first", behavior="sumo"),
            car(place(ROAD, 20, speed=8.0), place(ROAD, 120), name="second"),
        ),
        seconds=14.0,
    )
    trace = run(what, standing())
    assert 4.9 < closest(trace, "first", "second") < 12.0
    assert 4.9 < closest(trace, "first", "ego") < 12.0
    assert contacts(trace) == []


def test_friction_is_told_to_sumo_only_where_the_road_is_slippery(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    told: list[float] = []
    original = SumoWorld.set_friction

    def listen(world: SumoWorld, edges: object, friction: float) -> None:
        told.append(friction)
        original(world, edges, friction)  # type: ignore[arg-type]  # passed on as it came

    monkeypatch.setattr(SumoWorld, "set_friction", listen)
    run(scenario(parked(), seconds=0.1), standing())
    run(scenario(parked(), weather=WET, seconds=0.1), standing())
    assert told == [pytest.approx(0.4)]
