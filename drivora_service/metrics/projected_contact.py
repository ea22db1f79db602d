"""nuPlan's bound on the time to collision: whether boxes that move on straight meet within it.

As in nuPlan, places are sampled every 0.1 s, and only actors ahead of the rear axle count; beside
it they count while the ego is between lanes, off the road or in a junction. Velocities are those of
the actors: nuPlan takes their speed along their heading.
"""

from __future__ import annotations

import math

import numpy as np

from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import BoolArray, FloatArray, Int32Array
from drivora_service.geometry.boxes import overlap_depth
from drivora_service.observations.run_view import EgoView
from drivora_service.observations.trace import LEVEL_GAP, Col, SizeCol
from drivora_service.oracles.responsibility.nuplan import is_beside_lane

LEAST_TIME_TO_COLLISION = 0.95
"""Seconds."""

SAMPLING = 0.1
"""Seconds between the sampled places."""

STANDING_SPEED = 0.005
"""m/s up to which the ego stands and endangers no actor."""

AHEAD = math.radians(30.0)
"""Bearing from the rear axle up to which an actor is ahead, radians."""

BEHIND = math.radians(150.0)
"""Bearing from the rear axle from which on an actor is behind, radians."""

REAR_AXLE = 1.461 / 5.176
"""Metres from the centre back to the rear axle, by metre of length: nuPlan's Pacifica."""

OFF_ROAD = 0.3
"""Metres outside the drivable area from which on the ego is off the road."""


def contact_projected(ego: EgoView) -> bool:
    """Returns whether the time to collision is ever within the bound."""
    if not ego.count:
        return False
    soon = ego.proximity.time_to_collision <= LEAST_TIME_TO_COLLISION
    rows = np.flatnonzero(soon & (ego.speed > STANDING_SPEED))
    if not len(rows):
        return False
    trace = ego.trace
    touched = np.full(len(trace.actors), trace.step_count, dtype=np.int32)
    for contact in trace.contacts:
        for one, other in ((contact.ego, contact.other), (contact.other, contact.ego)):
            if one == ego.row:
                touched[other] = min(touched[other], contact.step)
    beside = np.array([_counts_beside(ego, k) for k in rows.tolist()])
    return bool(
        _meets(
            np.ascontiguousarray(trace.states),
            np.ascontiguousarray(trace.present),
            np.array([(actor.length, actor.width) for actor in trace.actors]),
            ego.row,
            (rows + ego.first).astype(np.int32),
            beside,
            touched,
            np.arange(SAMPLING, LEAST_TIME_TO_COLLISION, SAMPLING),
        )
    )


def _counts_beside(ego: EgoView, k: int) -> bool:
    return bool(ego.in_junction[k]) or is_beside_lane(ego, k, OFF_ROAD)


@compiled
def _meets(
    states: FloatArray,
    present: BoolArray,
    sizes: FloatArray,
    row: int,
    steps: Int32Array,
    beside: BoolArray,
    touched: Int32Array,
    times: FloatArray,
) -> bool:
    """Returns whether the ego's box meets another at any of the times ahead.

    Args:
        states, present: Of the trace.
        sizes: (N, 2), columns ``SizeCol``.
        row: The ego.
        steps: (m,) rows of the trace.
        beside: (m,) whether actors beside the ego count.
        touched: (N,) row from which on an actor has touched the ego, and counts no more.
        times: Seconds ahead.
    """
    length, width = sizes[row, SizeCol.LENGTH], sizes[row, SizeCol.WIDTH]
    for m in range(len(steps)):
        t = steps[m]
        ego = states[t, row]
        x, y, yaw = ego[Col.X], ego[Col.Y], ego[Col.YAW]
        cos, sin = math.cos(yaw), math.sin(yaw)
        back = REAR_AXLE * length
        for j in range(states.shape[1]):
            if j == row or not present[t, j] or t >= touched[j]:
                continue
            other = states[t, j]
            if abs(other[Col.Z] - ego[Col.Z]) > LEVEL_GAP:
                continue
            dx, dy = other[Col.X] - x, other[Col.Y] - y
            ahead, aside = dx * cos + dy * sin + back, -dx * sin + dy * cos
            bearing = abs(math.atan2(aside, ahead))
            if bearing >= AHEAD and (not beside[m] or bearing > BEHIND):
                continue
            dvx, dvy = other[Col.VX] - ego[Col.VX], other[Col.VY] - ego[Col.VY]
            for time in times:
                if (
                    overlap_depth(
                        dx + dvx * time, dy + dvy * time, yaw, length, width,
                        other[Col.YAW], sizes[j, SizeCol.LENGTH], sizes[j, SizeCol.WIDTH],
                    ) > 0.0
                ):  # fmt: skip
                    return True
    return False
