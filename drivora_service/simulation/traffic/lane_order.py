"""Keeps SUMO's order of the vehicles on a lane that of their places.

SUMO keeps the vehicles of a lane in a list from the last to the first, and finds the leader of each
in that list. A vehicle that the service moves past another on the same lane keeps its place in the
list until it leaves the lane: a driver behind both sees the one that is later in the list, and not
the wreck in front of it. A vehicle that has been passed so is seen again once the one that passed
has been off its lane for a step: SUMO sorts what comes onto a lane.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import BoolArray, FloatArray, IntArray
from drivora_service.observations.trace import LEVEL_GAP, Col, SizeCol
from drivora_service.simulation.sumo import MovedActor, SumoWorld
from drivora_service.simulation.world import World

_BESIDE = 4.0
"""Metres beside another vehicle up to which SUMO may have both on one lane."""

_WATCHED = 10
"""Frames for which an actor is looked at after it has passed another: SUMO measures along its
lanes, and so has it pass some steps earlier or later."""


class LaneOrder:
    """The moved actors that may be at a wrong place in SUMO's list of their lane."""

    def __init__(self, sumo: SumoWorld, world: World) -> None:
        """Takes SUMO, and the frames with all actors."""
        self._sumo = sumo
        self._world = world
        self._watched: dict[int, int] = {}
        self._passers: IntArray = np.zeros(0, dtype=np.int64)

    def tend(self, k: int, is_moved: BoolArray, actors: Mapping[int, MovedActor]) -> None:
        """Has the actors lifted off their lanes for a step that have passed others on them.

        Args:
            k: The frame that SUMO gets next.
            is_moved: (N,) rows that the service moves.
            actors: The actors that it moves, by row.
        """
        if k < 2:
            return
        world = self._world
        if len(self._passers) != len(is_moved):
            self._passers = np.zeros(len(is_moved), dtype=np.int64)
        # SUMO is at the frame before: what has passed another by then is out of order in it.
        count = find_passers(
            world.states[k - 2],
            world.present[k - 2],
            world.states[k - 1],
            world.present[k - 1],
            world.sizes,
            is_moved,
            self._passers,
        )
        for row in self._passers[:count].tolist():
            self._watched[row] = _WATCHED
        for row, left in list(self._watched.items()):
            actor = actors.get(row)
            if actor is None or left == 0:
                del self._watched[row]
            elif actor.is_on_lane and self._sumo.is_out_of_order(actor.id):
                actor.lifted = True
                del self._watched[row]
            else:
                self._watched[row] = left - 1


@compiled
def find_passers(
    before: FloatArray,
    present_before: BoolArray,
    after: FloatArray,
    present: BoolArray,
    sizes: FloatArray,
    is_moved: BoolArray,
    passers: IntArray,
) -> int:
    """Finds the moved rows whose fronts have passed another's from one frame to the next.

    Args:
        before: (N, 9) the earlier frame.
        present_before: (N,) of the earlier frame.
        after: (N, 9) the later frame.
        present: (N,) of the later frame.
        sizes: (N, 2), columns ``SizeCol``.
        is_moved: (N,) rows that the service moves.
        passers: (N,) is filled with the rows found.

    Returns:
        The number of rows found.
    """
    count = 0
    for i in range(after.shape[0]):
        if not (is_moved[i] and present[i] and present_before[i]):
            continue
        half = 0.5 * sizes[i, SizeCol.LENGTH]
        for j in range(after.shape[0]):
            if j == i or not (present[j] and present_before[j]):
                continue
            # Most actors are far away: this saves their angles.
            dx, dy = after[i, Col.X] - after[j, Col.X], after[i, Col.Y] - after[j, Col.Y]
            reach = half + 0.5 * sizes[j, SizeCol.LENGTH] + _BESIDE
            if abs(dx) > reach or abs(dy) > reach:
                continue
            if abs(after[i, Col.Z] - after[j, Col.Z]) > LEVEL_GAP:
                continue
            cos, sin = math.cos(after[j, Col.YAW]), math.sin(after[j, Col.YAW])
            if abs(dy * cos - dx * sin) > _BESIDE:
                continue
            lead = _lead(before[i], before[j], half, 0.5 * sizes[j, SizeCol.LENGTH])
            if lead < 0.0 <= _lead(after[i], after[j], half, 0.5 * sizes[j, SizeCol.LENGTH]):
                passers[count] = i
                count += 1
                break
    return count


@compiled
def _lead(one: FloatArray, two: FloatArray, half_one: float, half_two: float) -> float:
    """Returns the metres by which the front of one is ahead of the front of two, along two."""
    cos, sin = math.cos(two[Col.YAW]), math.sin(two[Col.YAW])
    x = one[Col.X] + half_one * math.cos(one[Col.YAW]) - two[Col.X]
    y = one[Col.Y] + half_one * math.sin(one[Col.YAW]) - two[Col.Y]
    return float(x * cos + y * sin - half_two)
