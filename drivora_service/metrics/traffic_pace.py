"""Speed of an ego relative to the surrounding traffic, by section of its route.

The test of minimum speed of CARLA Leaderboard 2.0 divides the route into sections. In each it
compares the ego's mean speed with the mean over the same moments of the mean speed of the traffic.
The Leaderboard has four sections, Bench2Drive twenty.
"""

from __future__ import annotations

from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.observations.run_view import EgoView
from drivora_service.observations.trace import Col, EgoCol, Role

LEADERBOARD_SECTIONS = 4
"""Sections of the route in CARLA Leaderboard 2.0 and 2.1."""

BENCH2DRIVE_SECTIONS = 20
"""Sections of the route in Bench2Drive."""

RADIUS = 50.0
"""Metres around the ego within which vehicles are surrounding traffic."""

STANDING_TRAFFIC = 0.1
"""Mean speed in m/s up to which the traffic stands, and has no pace."""

LAST_SECTION = 0.95
"""Share of the route from which on its last section counts, since routes end just before it."""

OUTLIER = 10.0
"""Ratio above which Bench2Drive leaves a section out."""

_VEHICLES = (Role.EGO, Role.NPC_VEHICLE, Role.BACKGROUND)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Moments:
    """The rows of an ego in which vehicles were around it.

    Attributes:
        share: (m,) share of the route that was driven.
        own: (m,) speed of the ego, m/s.
        theirs: (m,) mean speed of the vehicles around it, m/s.
        furthest: Greatest share of the route in any row, 0 if its place was never known.
    """

    share: FloatArray
    own: FloatArray
    theirs: FloatArray
    furthest: float


# Several metrics use them. Weak keys release them with their ego, which holds its whole trace.
_MOMENTS: WeakKeyDictionary[EgoView, _Moments] = WeakKeyDictionary()


def pace_ratios(ego: EgoView, sections: int) -> FloatArray:
    """Returns the ego's mean speed over that of the surrounding traffic, by section of the route.

    A section counts once the ego has left it, the last one once ``LAST_SECTION`` of the route is
    driven. In both means count the rows with vehicles around the ego.

    Args:
        ego: The ego.
        sections: Number of sections.

    Returns:
        (k,) ratios of the sections that count and had moving traffic.
    """
    moments = _MOMENTS.get(ego)
    if moments is None:
        moments = _MOMENTS[ego] = _moments(ego)
    section = np.minimum((moments.share * sections).astype(np.int64), sections - 1)
    rows = np.bincount(section, minlength=sections)
    own = np.bincount(section, moments.own, sections)
    theirs = np.bincount(section, moments.theirs, sections)
    counted = np.arange(1, sections + 1) <= moments.furthest * sections
    counted[-1] = moments.furthest > LAST_SECTION
    usable = counted & (theirs > STANDING_TRAFFIC * rows)
    ratios: FloatArray = own[usable] / theirs[usable]
    return ratios


def _moments(ego: EgoView) -> _Moments:
    trace = ego.trace
    share = ego.value(EgoCol.ROUTE_S) / ego.route.length
    known = share[np.isfinite(share)]
    furthest = float(known.max()) if len(known) else 0.0
    rows = [a.row for a in trace.actors if a.role in _VEHICLES and a.row != ego.row]
    if not rows or not ego.count:
        none = np.empty(0)
        return _Moments(share=none, own=none, theirs=none, furthest=furthest)
    part = slice(ego.first, ego.first + ego.count)
    x, y, vx, vy = (trace.states[part, rows, col] for col in (Col.X, Col.Y, Col.VX, Col.VY))
    dx, dy = x - ego.states[:, None, Col.X], y - ego.states[:, None, Col.Y]
    near = dx * dx + dy * dy <= RADIUS * RADIUS
    vehicles = near.sum(axis=1)
    speeds = np.where(near, np.sqrt(vx**2 + vy**2), 0.0)
    used = np.flatnonzero((vehicles > 0) & (share >= 0.0))
    return _Moments(
        share=share[used],
        own=ego.speed[used],
        theirs=speeds.sum(axis=1)[used] / vehicles[used],
        furthest=furthest,
    )


def efficiency(ego: EgoView) -> float | None:
    """Returns Bench2Drive's driving efficiency in per cent; ``None`` without traffic around."""
    ratios = pace_ratios(ego, BENCH2DRIVE_SECTIONS)
    ratios = ratios[ratios <= OUTLIER]
    return 100.0 * float(ratios.mean()) if len(ratios) else None


def slow_sections(ego: EgoView) -> tuple[float, ...]:
    """Returns the ratios below 1 of the Leaderboard's sections: one infraction each."""
    ratios = pace_ratios(ego, LEADERBOARD_SECTIONS)
    return tuple(ratios[ratios < 1.0].tolist())
