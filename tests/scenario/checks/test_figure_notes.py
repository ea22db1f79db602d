from __future__ import annotations

import math
from typing import Any

import pytest


def placed(result: Any) -> list[str]:
    """The notes that begin with a place."""
    return [note for note in result.notes if note.startswith("/")]


def test_a_heading_in_radians_is_noted(good: dict[str, Any], valid: Any) -> None:
    # The lane leads to the north.
    start = {"x": 131.6, "y": 30.0, "yaw": round(math.pi / 2, 2)}
    good["ego_vehicles"][0]["route"] = [start, {"x": 131.6, "y": 60.0, "yaw": 1.57}]
    (note,) = placed(valid(good))
    assert note.startswith("/ego_vehicles/0/route/0/yaw: 1.57° is across the lane there, and 1.57 ")
    assert note.endswith("1.57 rad are 90°")
    good["ego_vehicles"][0]["route"] = [{**start, "yaw": 90.0}, {"x": 131.6, "y": 60.0}]
    assert not placed(valid(good))


def test_a_heading_that_is_small_along_its_lane_is_not_noted(
    good: dict[str, Any], valid: Any
) -> None:
    good["ego_vehicles"][0]["route"][0]["yaw"] = -180.0
    good["npc_vehicles"] = [
        {
            "id": "npc",
            "model": "vehicle.audi.tt",
            "route": [{"x": 30.0, "y": 149.0, "yaw": 3.1}],
        }
    ]
    assert not placed(valid(good))


@pytest.mark.parametrize(
    ("size", "is_noted"),
    [({"length": 45.0}, True), ({"width": 0.1}, False), ({"length": 3.0, "width": 0.4}, False)],
)
def test_the_size_of_an_object_is_compared_with_its_model(
    good: dict[str, Any], valid: Any, size: dict[str, float], is_noted: bool
) -> None:
    good["npc_obstacles"] = [
        {
            "id": "cone",
            "model": "static.prop.trafficcone01",
            "location": {"x": 60.0, "y": 190.0},
            **size,
        }
    ]
    notes = placed(valid(good))
    assert bool(notes) is is_noted
    assert all(note.startswith("/npc_obstacles/0/length: 45 m; static.prop") for note in notes)


def test_a_patch_smoother_than_ice_is_noted(good: dict[str, Any], valid: Any) -> None:
    patch = {"id": "ice", "location": {"x": 60.0, "y": 152.1}, "length": 5.0, "width": 3.0}
    good["friction_patches"] = [{**patch, "friction": 0.02}]
    (note,) = placed(valid(good))
    assert note.startswith("/friction_patches/0/friction: 0.02; wet ice has about 0.05")
    good["friction_patches"] = [{**patch, "friction": 0.1}]
    assert not placed(valid(good))


def test_percentages_given_as_fractions_are_noted(good: dict[str, Any], valid: Any) -> None:
    good["weather"] = {"precipitation": 0.8, "wetness": 1.0}
    good["weather_changes"] = [
        {"time": 2.0, "weather": {"precipitation": 0.8, "wetness": 60.0}},
        {"time": 4.0, "weather": {"fog_density": 0.5}},
    ]
    first, second = placed(valid(good))
    assert first.startswith("/weather/precipitation: 0.8 %, which has hardly an effect")
    assert first.endswith("0.8 of 1 is 80")
    assert second.startswith("/weather_changes/1/weather/fog_density: 0.5 %")


def test_more_traffic_than_a_standing_queue_is_noted(good: dict[str, Any], valid: Any) -> None:
    good["background_traffic"] = {"count": 800}
    (note,) = placed(valid(good))
    assert note.startswith("/background_traffic: 800 vehicles on ")
    assert note.endswith("a standing queue has about 133")
    good["background_traffic"] = {"count": 10}
    assert not placed(valid(good))
