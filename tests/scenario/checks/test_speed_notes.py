from __future__ import annotations

from typing import Any

import pytest

NPC = "vehicle.audi.tt"


def placed(result: Any) -> list[str]:
    """The notes that begin with a place."""
    return [note for note in result.notes if note.startswith("/")]


def npc(**more: Any) -> dict[str, Any]:
    route = [{"x": 30.0, "y": 153.2}, {"x": 10.0, "y": 153.2}]
    return {"id": "npc", "model": NPC, "route": route, "behavior": "replay", **more}


def test_a_start_at_kilometres_an_hour_is_noted_with_the_limit_of_the_lane(
    good: dict[str, Any], valid: Any
) -> None:
    good["ego_vehicles"][0]["initial_speed"] = 50.0
    (note,) = placed(valid(good))
    assert note == (
        "/ego_vehicles/0/initial_speed: ego 'ego_0' starts at 50 m/s (180 km/h); the lane there "
        "allows 11.1 m/s (40 km/h); speeds are in m/s, and 50 km/h are 13.9 m/s"
    )


@pytest.mark.parametrize("speed", [0.0, 11.2, 16.0, 22.0])
def test_a_start_at_up_to_twice_the_limit_is_not_noted(
    good: dict[str, Any], valid: Any, speed: float
) -> None:
    good["ego_vehicles"][0]["initial_speed"] = speed
    assert not placed(valid(good))


def test_the_first_fast_waypoint_of_an_actor_is_noted(good: dict[str, Any], valid: Any) -> None:
    fast = npc()
    for waypoint in fast["route"]:
        waypoint["speed"] = 40.0
    slow = npc(id="slow", route=[{"x": 60.0, "y": 153.0}])
    good["npc_vehicles"] = [slow, fast]
    (note,) = placed(valid(good))
    assert note.startswith("/npc_vehicles/1/route/0/speed: 40 m/s (144 km/h); the lane there")
    assert "40 km/h are 11.1 m/s; 1 more of its waypoints are like it" in note
    for waypoint in fast["route"]:
        waypoint["speed"] = 21.0
    assert not placed(valid(good))


def test_a_walker_faster_than_a_runner_is_noted(good: dict[str, Any], valid: Any) -> None:
    walker: dict[str, Any] = {"id": "walker", "model": "walker.pedestrian.0001"}
    walker["route"] = [{"x": 40.0, "y": 160.0}, {"x": 40.0, "y": 145.0, "speed": 5.5}]
    good["npc_walkers"] = [walker]
    (note,) = placed(valid(good))
    assert note.startswith("/npc_walkers/0/route/1/speed: walker 'walker' moves at 5.5 m/s (19.8")
    walker["route"][1]["speed"] = 4.0
    assert not placed(valid(good))


def test_accelerations_that_no_road_allows_are_noted(good: dict[str, Any], valid: Any) -> None:
    good["npc_vehicles"] = [npc(deceleration=11.0, lateral_acceleration=11.5)]
    braking, side = placed(valid(good))
    assert braking.startswith("/npc_vehicles/0/deceleration: 11 m/s²; vehicle.audi.tt brakes with")
    assert side.startswith("/npc_vehicles/0/lateral_acceleration: 11.5 m/s²; a dry road allows 9.8")
    good["npc_vehicles"] = [npc(deceleration=8.0, lateral_acceleration=6.0)]
    assert not placed(valid(good))


def test_a_speed_among_the_parameters_of_an_agent_is_noted(
    good: dict[str, Any], valid: Any
) -> None:
    parameters: dict[str, Any] = {
        "target_speed": 50.0,
        "speed_factor": 50.0,
        "top_speed": "50",
        "speed": True,
    }
    good["ego_vehicles"][0]["agent"] = {"name": "idm", "parameters": parameters}
    (note,) = placed(valid(good))
    assert note.startswith(
        "/ego_vehicles/0/agent/parameters/target_speed: 50, in m/s 180 km/h; the lane"
    )
    parameters["target_speed"] = 20.0
    assert not placed(valid(good))


def test_a_reference_path_faster_than_the_vehicle_is_noted(
    good: dict[str, Any], valid: Any
) -> None:
    path = [
        {"time": float(n), "x": 100.0 - n, "y": 152.1, "yaw": 180.0, "speed": 10.0 + 80.0 * n}
        for n in range(2)
    ]
    good["ego_vehicles"][0]["reference_path"] = path
    (note,) = placed(valid(good))
    assert note.startswith("/ego_vehicles/0/reference_path/1/speed: 90 m/s (324 km/h); vehicle.lin")
