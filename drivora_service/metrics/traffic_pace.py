"""Speed of an ego relative to the surrounding traffic."""

from __future__ import annotations

from weakref import WeakKeyDictionary

import numpy as np

from drivora_service.geometry.arrays import FloatArray
from drivora_service.observations.run_view import EgoView
from drivora_service.observations.trace import Col, EgoCol, Role

CHECKPOINTS = 20
"""Sections of the route over which speeds are compared (Bench2Drive)."""

RADIUS = 50.0
"""Metres around the ego within which vehicles are surrounding traffic."""

_VEHICLES = (Role.EGO, Role.NPC_VEHICLE, Role.BACKGROUND)


# Two metrics use the ratios. Weak keys release them with their ego, which holds its whole trace.
_RATIOS: WeakKeyDictionary[EgoView, FloatArray] = WeakKeyDictionary()


def pace_ratios(ego: EgoView) -> FloatArray:
    """Returns the ego's mean speed over that of the surrounding traffic, by section of the route.

    Returns:
        (k,) ratios, for the at most ``CHECKPOINTS`` sections that the ego reached with moving
        vehicles around it.
    """
    found = _RATIOS.get(ego)
    if found is None:
        found = _RATIOS[ego] = _pace_ratios(ego)
    return found


def _pace_ratios(ego: EgoView) -> FloatArray:
    trace = ego.trace
    rows = [a.row for a in trace.actors if a.role in _VEHICLES and a.row != ego.row]
    if not rows or not ego.count:
        return np.empty(0)
    part = slice(ego.first, ego.first + ego.count)
    x, y, vx, vy = (trace.states[part, rows, col] for col in (Col.X, Col.Y, Col.VX, Col.VY))
    dx, dy = x - ego.states[:, None, Col.X], y - ego.states[:, None, Col.Y]
    near = dx * dx + dy * dy <= RADIUS * RADIUS
    squares = vx**2 + vy**2
    speeds = np.where(near, np.sqrt(squares), 0.0)
    vehicles = near.sum(axis=1)
    share = np.nan_to_num(ego.value(EgoCol.ROUTE_S) / ego.route.length, nan=-1.0)
    section = np.floor(share * CHECKPOINTS).astype(np.int64)
    inside = (section >= 0) & (section < CHECKPOINTS)
    counted = section[inside]
    seen = np.bincount(counted, vehicles[inside], CHECKPOINTS)
    their_sum = np.bincount(counted, speeds.sum(axis=1)[inside], CHECKPOINTS)
    own_sum = np.bincount(counted, ego.speed[inside], CHECKPOINTS)
    rows_in = np.bincount(counted, minlength=CHECKPOINTS)
    moving = their_sum > 0.1 * seen
    usable = (seen > 0) & moving
    ratios: FloatArray = (own_sum[usable] / rows_in[usable]) / (their_sum[usable] / seen[usable])
    return ratios


def efficiency(ego: EgoView) -> float | None:
    """Returns Bench2Drive's driving efficiency in per cent; ``None`` without traffic around."""
    ratios = pace_ratios(ego)
    return 100.0 * float(ratios.mean()) if len(ratios) else None


def minimum_speed(ego: EgoView) -> float | None:
    """Returns the Leaderboard's minimum-speed percentage, at most 100; ``None`` without traffic."""
    ratios = pace_ratios(ego)
    return 100.0 * float(np.minimum(ratios, 1.0).mean()) if len(ratios) else None
