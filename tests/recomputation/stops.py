"""Which stop signs an ego drove past without having stood."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tests.recomputation.recording import Drive, Recording
from tests.recomputation.signals import FRONT_WIDTH, crossings, ways_taken
from tests.recomputation.town import Movement, read_town

STANDING = 0.1
"""m/s below which an ego stands (Leaderboard)."""

WINDOW = 0.5
"""Seconds over which it must have stood."""

REACH = 4.0
"""Metres before the line within which it must have stood (Leaderboard)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StopPassed:
    """A line at which the ego may have had to stop.

    Attributes:
        lane: The lane that ends there.
        step: First step with the front beyond the line.
        ran: Whether it had to stop and had not stood; ``None`` where the ways that it may have
            taken differ.
    """

    lane: str
    step: int
    ran: bool | None


def stops_passed(run: Recording, drive: Drive) -> list[StopPassed]:
    """Returns every line that the ego's front crossed and at which it had to stop, or may have."""
    town = read_town(run.head["network"])
    found = []
    for lane in town.lanes.values():
        if lane.inside or not lane.movements:
            continue
        for front in crossings(drive, lane, 0.5 * drive.length, FRONT_WIDTH):
            step = drive.first + front
            centres = np.column_stack((drive.x, drive.y))[front:]
            must = {_must_stop(run, way, step) for way in ways_taken(town, lane, centres)}
            if must == {False}:
                continue
            ran: bool | None = not _stood(run, drive, front)
            if ran and len(must) > 1:
                ran = None
            found.append(StopPassed(lane=lane.id, step=step, ran=ran))
    return sorted(found, key=lambda one: one.step)


def _must_stop(run: Recording, way: Movement, step: int) -> bool:
    if way.light:
        return run.signal(way.light, way.link)[step] == "s"
    return way.state in ("s", "w")


def _stood(run: Recording, drive: Drive, front: int) -> bool:
    """Returns whether the ego came on more slowly than it may, over a window close to the line."""
    driven = np.cumsum(drive.moved)
    rows = [k for k in range(front) if driven[front - 1] - driven[k] <= REACH]
    if rows[0] == 0 and drive.speed[0] < STANDING:
        return True
    span = max(1, round(WINDOW / run.step_length))
    for k in rows:
        end = min(k + span, front)
        if end - k < min(span, front - rows[0]):
            continue
        came = np.hypot(drive.x[end] - drive.x[k], drive.y[end] - drive.y[k])
        if came / ((end - k) * run.step_length) < STANDING:
            return True
    return False
