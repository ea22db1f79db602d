"""Conversion of a scenario to a document, which validates to the identical scenario."""

from __future__ import annotations

import math
from typing import Any

from drivora_service.scenario.documents import ScenarioDocument
from drivora_service.scenario.frames import FrameTransform
from drivora_service.scenario.model import (
    EgoVehicle,
    LightTimes,
    NpcObstacle,
    NpcVehicle,
    ReferencePose,
    Region,
    Scenario,
    Waypoint,
    Weather,
)

_NEIGHBOURS = 64
"""Number of neighbouring floating-point numbers that are tried on either side."""


def to_document(scenario: Scenario) -> ScenarioDocument:
    """Returns the document of a scenario, in the network's plane."""
    return ScenarioDocument.model_validate(document_content(scenario))


def document_content(scenario: Scenario) -> dict[str, Any]:
    """Returns the plain data of a scenario's document.

    The keys are in the order of the document's fields. The values are not checked: a number out
    of a document's bounds stays as it is.
    """
    background, lights = scenario.background_traffic, scenario.traffic_lights
    return {
        "frame": "sumo",
        "ego_vehicles": [_ego(ego) for ego in scenario.ego_vehicles],
        "npc_vehicles": [_npc(npc) for npc in scenario.npc_vehicles],
        "npc_walkers": [
            {
                "id": walker.id,
                "model": walker.model,
                "route": _route(walker.route),
                "start_time": walker.start_time,
                "joins": walker.joins,
            }
            for walker in scenario.npc_walkers
        ],
        "npc_obstacles": [_obstacle(obstacle) for obstacle in scenario.npc_obstacles],
        "friction_patches": [
            {
                "id": patch.id,
                "location": _place(patch.location),
                "length": patch.length,
                "width": patch.width,
                "friction": patch.friction,
            }
            for patch in scenario.friction_patches
        ],
        "map_region": {
            "town": scenario.map_region.town,
            "region_segment": _region(scenario.map_region.region_segment),
        },
        "weather": _weather(scenario.weather),
        "weather_changes": [
            {"time": change.time, "weather": _weather(change.weather)}
            for change in scenario.weather_changes
        ],
        "traffic_lights": {
            **_light_times(lights.times),
            "junctions": {light: _light_times(times) for light, times in lights.junctions.items()},
        },
        "background_traffic": None
        if background is None
        else {"count": background.count, "start_time": background.start_time},
        "seed": scenario.seed,
        "step_length": scenario.step_length,
        "max_sim_time": scenario.max_sim_time,
        "stuck_after": scenario.stuck_after,
        "extensions": dict(scenario.extensions),
    }


def _yaw(angle: float) -> float:
    """Returns the degrees that are read back as exactly ``angle``, if there are any."""
    if not math.isfinite(angle):
        return angle
    frame = FrameTransform()
    value = frame.yaw_from_network(angle)
    for limit in (-math.inf, math.inf):
        candidate = value
        for _ in range(_NEIGHBOURS):
            if frame.yaw_to_network(candidate) == angle:
                return candidate
            candidate = math.nextafter(candidate, limit)
    return value


def _weather(weather: Weather) -> dict[str, float]:
    return {name: getattr(weather, name) for name in weather.__dataclass_fields__}


def _route(route: tuple[Waypoint, ...]) -> list[dict[str, float]]:
    return [_place(waypoint) for waypoint in route]


def _place(waypoint: Waypoint) -> dict[str, float]:
    place = {"x": waypoint.x, "y": waypoint.y}
    if waypoint.z is not None:
        place["z"] = waypoint.z
    if waypoint.yaw is not None:
        place["yaw"] = _yaw(waypoint.yaw)
    if waypoint.speed is not None:
        place["speed"] = waypoint.speed
    if waypoint.wait is not None:
        place["wait"] = waypoint.wait
    return place


def _ego(ego: EgoVehicle) -> dict[str, Any]:
    return {
        "id": ego.id,
        "model": ego.model,
        "route": _route(ego.route),
        "start_time": ego.start_time,
        "initial_speed": ego.initial_speed,
        "dynamics": ego.dynamics,
        "agent": {"name": ego.agent.name, "parameters": dict(ego.agent.parameters)},
        "reference_path": [_pose(pose) for pose in ego.reference_path],
    }


def _pose(pose: ReferencePose) -> dict[str, float]:
    content = {
        "time": pose.time,
        "x": pose.x,
        "y": pose.y,
        "yaw": _yaw(pose.yaw),
        "speed": pose.speed,
    }
    if pose.z is not None:
        content["z"] = pose.z
    return content


def _npc(npc: NpcVehicle) -> dict[str, Any]:
    return {
        "id": npc.id,
        "model": npc.model,
        "route": _route(npc.route),
        "start_time": npc.start_time,
        "behavior": npc.behavior.value,
        "at_end": npc.at_end.value,
        "deceleration": npc.deceleration,
        "lateral_acceleration": npc.lateral_acceleration,
        "joins": npc.joins,
    }


def _obstacle(obstacle: NpcObstacle) -> dict[str, Any]:
    return {
        "id": obstacle.id,
        "model": obstacle.model,
        "location": _place(obstacle.location),
        "length": obstacle.length,
        "width": obstacle.width,
        "start_time": obstacle.start_time,
    }


def _region(region: Region | None) -> dict[str, float] | None:
    if region is None:
        return None
    return {
        "min_x": region.min_x,
        "max_x": region.max_x,
        "min_y": region.min_y,
        "max_y": region.max_y,
    }


def _light_times(times: LightTimes) -> dict[str, float | None]:
    return {
        "green_time": times.green,
        "red_time": times.red,
        "yellow_time": times.yellow,
        "offset": times.offset,
    }
