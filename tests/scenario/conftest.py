"""A valid document and the shipped networks."""

from __future__ import annotations

import copy
from typing import Any

import pytest

GOOD: dict[str, Any] = {
    "version": "1.0",
    "frame": "sumo",
    "ego_vehicles": [
        {
            "id": "ego_0",
            "model": "vehicle.lincoln.mkz_2017",
            "route": [{"x": 20.0, "y": 98.4}, {"x": 180.0, "y": 98.4}],
            "agent": {"name": "idm"},
        }
    ],
    "map_region": {"town": "tee-town"},
}


@pytest.fixture
def good() -> dict[str, Any]:
    """A small valid document, to be changed by the test."""
    return copy.deepcopy(GOOD)
