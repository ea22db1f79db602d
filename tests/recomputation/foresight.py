"""Boxes that move on straight and meet, by polygons."""

from __future__ import annotations

import numpy as np
import shapely

from tests.recomputation.boxes import LEVELS, corners
from tests.recomputation.recording import Drive, Flags, Recording
from tests.recomputation.surfaces import corners_outside, lane_headings, lane_offsets
from tests.recomputation.town import read_town

TIMES = tuple(0.1 * n for n in range(1, 10))
"""Seconds: those below the bound of 0.95 s."""

AXLE = 1.461 / 5.176
"""Of the length, from the centre back to the rear axle."""


def reaches_over(town: str, drive: Drive) -> Flags:
    """Tells the (n,) rows in which actors beside the ego count.

    It reaches over the edge of its lane, is off the road, or is in a junction.
    """
    lanes = read_town(town).lanes
    inside = np.array([not name or lanes[name].inside for name in drive.lanes])
    turn = drive.yaw - lane_headings(town, drive)
    reach = 0.5 * drive.length * np.abs(np.sin(turn)) + 0.5 * drive.width * np.abs(np.cos(turn))
    half = np.array([0.5 * lanes[name].width if name else np.nan for name in drive.lanes])
    with np.errstate(invalid="ignore"):
        over = np.abs(lane_offsets(town, drive)) + reach > half
    return np.asarray(inside | over | (corners_outside(town, drive) > 0.3))


def meets_soon(run: Recording, drive: Drive, touched: dict[str, int]) -> bool:
    """Returns whether the ego's box would meet another's within the bound, in any row."""
    beside_counts = reaches_over(run.head["network"], drive)
    back = AXLE * drive.length
    rows = np.arange(drive.first, drive.first + drive.count)
    for j, actor in enumerate(run.head["actors"]):
        if j == drive.actor:
            continue
        x, y, yaw, vx, vy, z = (
            run.states[name][rows, j] for name in ("x", "y", "yaw", "vx", "vy", "z")
        )
        to = (x - drive.x) + 1j * (y - drive.y)
        seen = to * np.exp(-1j * drive.yaw) + back
        with np.errstate(invalid="ignore"):
            bearing = np.abs(np.degrees(np.angle(seen)))
            counts = (bearing < 30.0) | (beside_counts & (bearing <= 150.0))
            counts &= (drive.speed > 0.005) & (np.abs(z - drive.z) <= LEVELS)
            counts &= rows < touched.get(actor["id"], rows[-1] + 1)
            reach = 0.5 * np.hypot(actor["length"], actor["width"])
            reach += 0.5 * np.hypot(drive.length, drive.width)
            closing = np.hypot(vx - drive.vx, vy - drive.vy)
            counts &= np.abs(to) <= reach + closing * TIMES[-1]
        for k in np.flatnonzero(counts).tolist():
            steps = np.array(TIMES)
            theirs = corners(
                x[k] + vx[k] * steps,
                y[k] + vy[k] * steps,
                np.full(len(steps), yaw[k]),
                actor["length"],
                actor["width"],
            )
            own = corners(
                drive.x[k] + drive.vx[k] * steps,
                drive.y[k] + drive.vy[k] * steps,
                np.full(len(steps), drive.yaw[k]),
                drive.length,
                drive.width,
            )
            common = shapely.intersection(shapely.polygons(own), shapely.polygons(theirs))
            if (shapely.area(common) > 0.0).any():
                return True
    return False
