"""Contacts of actors, by the outlines of the boxes."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from tests.recomputation.recording import Drive, Floats, Recording

LEVELS = 3.0
"""Metres of height beyond which two actors do not meet."""


def corners(x: Floats, y: Floats, yaw: Floats, length: float, width: float) -> Floats:
    """Returns the (n, 4, 2) corners of boxes around their centres."""
    turn = np.exp(1j * yaw)[:, None]
    own = 0.5 * np.array([length + 1j * width, -length + 1j * width])
    spots = (x + 1j * y)[:, None] + turn * np.concatenate((own, -own))
    return np.stack((spots.real, spots.imag), axis=-1)


def outlines(x: Floats, y: Floats, yaw: Floats, length: float, width: float) -> NDArray[np.object_]:
    """Returns the (n,) boxes as polygons."""
    return np.asarray(shapely.polygons(corners(x, y, yaw, length, width)))


def collisions(run: Recording, drive: Drive) -> dict[str, int]:
    """Returns the step of the first overlap with every actor that the ego's box overlapped."""
    found = {}
    rows = np.arange(drive.first, drive.first + drive.count)
    for other, actor in enumerate(run.head["actors"]):
        if other == drive.actor:
            continue
        x, y, yaw, z = (run.states[name][rows, other] for name in ("x", "y", "yaw", "z"))
        reach = 0.5 * sum(np.hypot(a["length"], a["width"]) for a in (actor, _facts(drive)))
        with np.errstate(invalid="ignore"):
            near = np.hypot(x - drive.x, y - drive.y) < reach
            near &= np.abs(z - drive.z) <= LEVELS
        if not near.any():
            continue
        theirs = outlines(x[near], y[near], yaw[near], actor["length"], actor["width"])
        own = outlines(drive.x[near], drive.y[near], drive.yaw[near], drive.length, drive.width)
        touched = shapely.area(shapely.intersection(own, theirs)) > 0.0
        if touched.any():
            found[actor["id"]] = int(rows[near][np.argmax(touched)])
    return found


def _facts(drive: Drive) -> dict[str, float]:
    return {"length": drive.length, "width": drive.width}


def impact_speed(run: Recording, drive: Drive, step: int, other: str) -> float:
    """Returns the ego's speed on the way into an overlap, m/s."""
    ids = [actor["id"] for actor in run.head["actors"]]
    k = step - drive.first
    if step == 0 or np.isnan(run.states["x"][step - 1, ids.index(other)]):
        return float(drive.speed[k])
    dx, dy = (np.diff(run.states[n][step - 1 : step + 1, drive.actor])[0] for n in ("x", "y"))
    return float(np.hypot(dx, dy) / run.step_length)
