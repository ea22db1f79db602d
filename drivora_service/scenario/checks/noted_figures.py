"""The words of notes on figures that are allowed, but far from what their place allows.

Such a figure is mostly one in another unit: km/h for m/s, milliseconds for seconds, a fraction for
a percentage. It is a note, never a problem: a scenario may want it.
"""

from __future__ import annotations

from collections.abc import Iterable

from drivora_service.networks.projection import lane_positions_near
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.scenario.plain_data import pointer

FAST_FACTOR = 2.0
"""How many times the speed limit a speed may be without being noted: methods vary speeds up to
that, and km/h in place of m/s are 3.6 times as much."""
KMH = 3.6
"""km/h of one m/s."""
_NEAR = 10.0
"""Metres around a place whose lanes count: in a junction those of bends have lower limits."""


def placed(tokens: Iterable[str | int], message: str) -> str:
    """Returns a note with the JSON pointer to its place."""
    return f"{pointer(tokens)}: {message}"


def speed_words(speed: float) -> str:
    """Returns a speed in m/s and km/h."""
    return f"{speed:.3g} m/s ({speed * KMH:.3g} km/h)"


def duration_words(seconds: float) -> str:
    """Returns a duration in seconds and, where it is long, in minutes."""
    return f"{seconds:g} s" if seconds < 120.0 else f"{seconds:g} s ({seconds / 60.0:.3g} min)"


def limit_near(network: RoadNetwork, x: float, y: float) -> float | None:
    """Returns the greatest speed limit of the lanes at a place, m/s; ``None`` off the road."""
    near = lane_positions_near(network, x, y, max_distance=_NEAR)
    return max((network.lanes[one.lane].speed_limit for one in near), default=None)


def other_unit(speed: float) -> str:
    """Returns what a speed in m/s is if it was meant in km/h."""
    return f"speeds are in m/s, and {speed:g} km/h are {speed / KMH:.3g} m/s"
