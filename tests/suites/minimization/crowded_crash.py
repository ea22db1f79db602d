"""A scenario that certainly fails, fast: a scripted ego drives into a container, others look on."""

from __future__ import annotations

from typing import Any

from drivora_service.api.documentation.recorded_examples import SCENARIO

CONTAINER: dict[str, Any] = {
    "id": "container",
    "model": "static.prop.container",
    "location": {"x": 3.4, "y": 50.0, "yaw": 91.51},
}
"""On the route of the ego."""


def crowded_crash() -> dict[str, Any]:
    """The document: a walker, a car behind, rain and extensions do not matter for the collision."""
    (ego,) = SCENARIO["ego_vehicles"]
    return {
        **SCENARIO,
        "ego_vehicles": [{**ego, "agent": {"name": "scripted"}}],
        "npc_obstacles": [CONTAINER],
        "npc_vehicles": [
            {
                "id": "parked",
                "model": "vehicle.lincoln.mkz_2017",
                "behavior": "replay",
                "route": [{"x": 4.123, "y": 96.5}],
            }
        ],
        "npc_walkers": [
            {
                "id": "walker",
                "model": "walker.pedestrian.0001",
                "route": [
                    {"x": -2.0, "y": 62.0},
                    {"x": -2.0, "y": 70.25},
                    {"x": -2.0, "y": 82.5, "speed": 1.25},
                ],
            }
        ],
        "weather": {"precipitation": 40.0, "wetness": 55.5},
        "extensions": {"tests:note": {"of": "nothing"}},
    }


ONLY_NEEDED = {"ego", "container"}
"""Ids of the actors without which there is no such collision."""
