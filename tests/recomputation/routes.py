"""An ego's progress on its route, leaving the route, and arrival."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tests.recomputation.recording import Drive, Flags, Floats, Recording

FAR = 30.0
BESIDE = 15.0
BESIDE_SHARE = 0.3
"""Of the Leaderboard's test for route deviation: metres, metres, share of the route's length."""

ARRIVED_SHARE = 0.99
ARRIVED_DISTANCE = 10.0

QUEUE = 100.0
"""Metres before the line of a signal within which an ego may be waiting for it."""

OWN_ROAD = 8.0
"""Metres from the route up to which the ego is on it, as far as signals are concerned."""

AHEAD = 5.0
"""Metres beyond what the ego has driven that its place on the route may move ahead in a step."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Progress:
    """An ego on its route.

    Attributes:
        along: (n,) metres along the reference line.
        beside: (n,) metres from it.
    """

    along: Floats
    beside: Floats


def follow_route(drive: Drive) -> Progress:
    """Returns the nearest place on the route in each row.

    It is looked for on the pieces of the line that begin at most so far ahead of that of the row
    before as the ego has driven, and a little: a route may pass a place twice.
    """
    base, step = drive.line[:-1], np.diff(drive.line, axis=0)
    long = np.hypot(step[:, 0], step[:, 1])
    along, beside = np.zeros(drive.count), np.zeros(drive.count)
    last, piece = 0.0, 0
    for k in range(drive.count):
        furthest = drive.arc[piece] + drive.moved[k] + AHEAD
        near = np.flatnonzero((drive.arc[1:] >= last - 4.0) & (drive.arc[:-1] < furthest))
        spot = np.array([drive.x[k], drive.y[k]]) - base[near]
        share = np.clip(np.einsum("ij,ij->i", spot, step[near]) / long[near] ** 2, 0.0, 1.0)
        away = np.hypot(*(spot - share[:, None] * step[near]).T)
        best = int(np.argmin(away))
        piece = int(near[best])
        last = float(drive.arc[piece] + share[best] * long[piece])
        along[k], beside[k] = last, away[best]
    return Progress(along=along, beside=beside)


def deviation_row(drive: Drive, progress: Progress) -> int | None:
    """Returns the first row in which the ego has left its route."""
    driven_beside = np.cumsum(np.where(progress.beside > BESIDE, drive.moved, 0.0))
    left = (progress.beside > FAR) | (driven_beside > BESIDE_SHARE * drive.arc[-1])
    return int(np.argmax(left)) if left.any() else None


def waits_at_signal(drive: Drive, progress: Progress) -> Flags:
    """Tells the (n,) rows in which the ego stands before a signal that is not green."""
    with np.errstate(invalid="ignore"):
        waits = (drive.light >= 2.0) & (drive.light_distance < QUEUE) & (drive.speed < 0.1)
    return np.asarray(waits & (progress.beside <= OWN_ROAD))


def arrived(run: Recording, drive: Drive, progress: Progress) -> bool:
    """Returns whether the ego came to its goal within its time limit.

    What it waits before a signal that is not green, also in the queue, does not count.
    """
    away = np.hypot(drive.x - drive.goal[0], drive.y - drive.goal[1])
    there = (progress.along > ARRIVED_SHARE * drive.arc[-1]) & (away < ARRIVED_DISTANCE)
    if not there.any():
        # SUMO takes the vehicles that it drives off the road at the end of their last edge.
        return drive.end == "arrived"
    row = int(np.argmax(there))
    waits = waits_at_signal(drive, progress)
    allowed = 0.8 * drive.arc[-1] + 5.0 + np.count_nonzero(waits[: row + 1]) * run.step_length
    seconds = row * run.step_length
    return bool(seconds <= min(allowed, run.head["max_sim_time"] - drive.start_time) + 1e-6)


def route_completion(run: Recording, drive: Drive, progress: Progress) -> float:
    """Returns per cent of the route."""
    if not drive.count:
        return 0.0
    if arrived(run, drive, progress):
        return 100.0
    left = deviation_row(drive, progress)
    done = progress.along if left is None else progress.along[: left + 1]
    return 100.0 * min(float(done.max()) / float(drive.arc[-1]), 1.0)


def traffic_pace(run: Recording, drive: Drive, progress: Progress, sections: int) -> list[float]:
    """Returns the ego's speed over that of the vehicles within 50 m, by section of the route.

    A section is compared once the ego has left it, the last one once 95 % of the route are driven,
    if vehicles were around that moved.
    """
    rows = slice(drive.first, drive.first + drive.count)
    vehicles = [
        i
        for i, actor in enumerate(run.head["actors"])
        if actor["role"] in ("ego", "npc_vehicle", "background") and i != drive.actor
    ]
    x, y, vx, vy = (run.states[name][rows][:, vehicles] for name in ("x", "y", "vx", "vy"))
    moments: dict[int, list[tuple[float, float]]] = {}
    for k in range(drive.count):
        with np.errstate(invalid="ignore"):
            near = (x[k] - drive.x[k]) ** 2 + (y[k] - drive.y[k]) ** 2 <= 50.0**2
        if near.any():
            section = min(int(sections * progress.along[k] / drive.arc[-1]), sections - 1)
            theirs = float(np.hypot(vx[k][near], vy[k][near]).mean())
            moments.setdefault(section, []).append((float(drive.speed[k]), theirs))
    driven = float(progress.along.max(initial=0.0)) / float(drive.arc[-1])
    ratios = []
    for section, pairs in sorted(moments.items()):
        last = section == sections - 1
        left = driven > 0.95 if last else driven * sections >= section + 1
        own, theirs = (float(np.mean(values)) for values in zip(*pairs, strict=True))
        if left and theirs > 0.1:
            ratios.append(own / theirs)
    return ratios
