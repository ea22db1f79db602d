"""Scores of simulated proposals, by nuPlan's terms as in PDM-Closed; compiled.

Source: Dauner, Hallgarten, Geiger, Chitta, *Parting with Misconceptions about Learning-based
Vehicle Motion Planning* (2023), and nuPlan's metrics. The terms that multiply: no collision at
fault, drivable area, driving direction. The averaged terms: progress, time to collision,
comfort.
"""

from __future__ import annotations

import math
from enum import IntEnum

import numpy as np

from drivora_service.agents.idm.run_following import WayCol
from drivora_service.agents.pdm_closed.forecast import STEP, FutureCol
from drivora_service.agents.pdm_closed.margins import MarginCol
from drivora_service.agents.pdm_closed.proposals import ProposalCol
from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.geometry.boxes import overlap_depth
from drivora_service.observations.trace import SizeCol

PROGRESS_WEIGHT = 5.0
TIME_TO_COLLISION_WEIGHT = 5.0
COMFORT_WEIGHT = 2.0
_STANDS = 0.1
_CLEARANCE = 0.15
"""Metres by which the ego's box is larger on each side than the ego."""
_SLACK = 0.02
"""Metres by which a box that is outside already may go further outside."""
_LEAST_PROGRESS = 0.5
"""Metres; if no proposal gets further, progress does not count."""
_LOOKS = 3
_LOOK = 3
"""Steps of the search for the time to collision, and simulation steps in each: up to 0.9 s."""
_MAX_PULL = 2.40
_MAX_BRAKING = 4.05
_MAX_SIDE = 4.89
_MAX_JERK = 8.37
_MAX_YAW_RATE = 0.95
_MAX_YAW_ACCELERATION = 1.93


class ScoreCol(IntEnum):
    """Columns of what was found of proposals."""

    SCORE = 0
    """0..1."""
    COLLISION_TIME = 1
    """Seconds to the first collision at fault; inf without one."""
    PROGRESS = 2
    """Metres."""
    KEEPS_TIME = 3
    """1 if the time to collision is kept, else 0."""
    IS_COMFORTABLE = 4
    """1 if it keeps the limits of comfort, else 0."""


@compiled
def _touches(
    x: float,
    y: float,
    yaw: float,
    half_length: float,
    half_width: float,
    there: FloatArray,
    size: FloatArray,
) -> bool:
    dx, dy = there[FutureCol.X] - x, there[FutureCol.Y] - y
    length, width = size[SizeCol.LENGTH], size[SizeCol.WIDTH]
    reach = half_length + half_width + 0.5 * (length + width)
    if abs(dx) > reach or abs(dy) > reach:
        return False
    depth = overlap_depth(
        dx, dy, yaw, 2.0 * half_length, 2.0 * half_width, there[FutureCol.YAW], length, width
    )
    return depth > 0.0


@compiled
def first_collision(
    path: FloatArray, half_length: float, half_width: float, future: FloatArray, sizes: FloatArray
) -> int:
    """Finds the first collision at the ego's fault.

    The ego is not at fault if it stands, is hit from behind, or overlaps already.

    Returns:
        The step, or the number of steps if there is none.
    """
    steps: int = path.shape[0]
    for j in range(sizes.shape[0]):
        x, y, yaw = path[0, ProposalCol.X], path[0, ProposalCol.Y], path[0, ProposalCol.YAW]
        if _touches(x, y, yaw, half_length, half_width, future[0, j], sizes[j]):
            continue
        for k in range(1, steps):
            x, y, yaw = path[k, ProposalCol.X], path[k, ProposalCol.Y], path[k, ProposalCol.YAW]
            there = future[k, j]
            if not _touches(
                x, y, yaw, half_length + _CLEARANCE, half_width + _CLEARANCE, there, sizes[j],
            ):  # fmt: skip
                continue
            if path[k, ProposalCol.SPEED] < _STANDS:
                break
            dx, dy = there[FutureCol.X] - x, there[FutureCol.Y] - y
            ahead = dx * math.cos(yaw) + dy * math.sin(yaw)
            if ahead < 0.0 and there[FutureCol.SPEED] > _STANDS:
                break
            steps = min(steps, k)
            break
    return steps


@compiled
def keeps_time_to_collision(
    path: FloatArray, half_length: float, half_width: float, future: FloatArray, sizes: FloatArray
) -> bool:
    """Returns whether the ego, at constant velocity, touches no actor ahead within 0.9 s."""
    last = path.shape[0] - 1
    for k in range(0, last - _LOOKS * _LOOK + 1, 2):
        x, y, yaw = path[k, ProposalCol.X], path[k, ProposalCol.Y], path[k, ProposalCol.YAW]
        speed = path[k, ProposalCol.SPEED]
        if speed < _STANDS:
            continue
        cos, sin = math.cos(yaw), math.sin(yaw)
        for look in range(1, _LOOKS + 1):
            after = k + look * _LOOK
            way = speed * look * _LOOK * STEP
            px, py = x + way * cos, y + way * sin
            for j in range(sizes.shape[0]):
                there = future[after, j]
                if not _touches(px, py, yaw, half_length, half_width, there, sizes[j]):
                    continue
                if (there[FutureCol.X] - px) * cos + (there[FutureCol.Y] - py) * sin > 0.0:
                    return False
    return True


@compiled
def stays_on_road(
    path: FloatArray, half_length: float, half_width: float, way: FloatArray, margins: FloatArray
) -> tuple[bool, float]:
    """Returns whether the box stays in the drivable area, and its distance in oncoming lanes.

    Only places further outside than the ego's present one count as outside.
    """
    allowed, oncoming = 0.0, 0.0
    # Beyond the end of its line the road is unknown.
    at, end = 0, way[way.shape[0] - 1, WayCol.ARC] - 0.1
    for k in range(path.shape[0]):
        s, side = path[k, ProposalCol.ARC], path[k, ProposalCol.SIDE]
        if s >= end:
            break
        if k == 0:
            at = int(np.searchsorted(way[:, WayCol.ARC], s))
        while at < way.shape[0] - 2 and way[at + 1, WayCol.ARC] < s:
            at += 1
        at = min(max(at, 0), way.shape[0] - 2)
        line_yaw = math.atan2(
            way[at + 1, WayCol.Y] - way[at, WayCol.Y], way[at + 1, WayCol.X] - way[at, WayCol.X]
        )
        turned = path[k, ProposalCol.YAW] - line_yaw
        across = half_width * abs(math.cos(turned)) + half_length * abs(math.sin(turned))
        left, right = margins[at, MarginCol.LEFT], margins[at, MarginCol.RIGHT]
        outside = max(side + across - left, across - side - right)
        if k == 0:
            allowed = max(outside, 0.0) + _SLACK
        elif outside > allowed:
            return False, oncoming
        if k > 0 and side > margins[at, MarginCol.ONCOMING]:
            oncoming += path[k, ProposalCol.SPEED] * STEP
    return True, oncoming


@compiled
def is_comfortable(path: FloatArray, before: float) -> bool:
    """Returns whether a proposal keeps nuPlan's limits of comfort.

    Args:
        path: (K, 8) the proposal, columns ``ProposalCol``.
        before: Acceleration before it, m/s².
    """
    pull, turn = before, 0.0
    for k in range(path.shape[0] - 1):
        speed = path[k, ProposalCol.SPEED]
        asked = path[k, ProposalCol.ACCELERATION] if speed > _STANDS else 0.0
        if asked > _MAX_PULL or asked < -_MAX_BRAKING:
            return False
        if k > 0 and abs(asked - pull) / STEP > _MAX_JERK and speed > 2.0 * _STANDS:
            return False
        rate = (path[k + 1, ProposalCol.YAW] - path[k, ProposalCol.YAW]) / STEP
        if abs(rate) > _MAX_YAW_RATE or abs(rate * speed) > _MAX_SIDE:
            return False
        if k > 0 and abs(rate - turn) / STEP > _MAX_YAW_ACCELERATION:
            return False
        pull, turn = asked, rate
    return True


@compiled
def score(
    paths: FloatArray,
    before: float,
    half_length: float,
    half_width: float,
    way: FloatArray,
    margins: FloatArray,
    future: FloatArray,
    sizes: FloatArray,
    out: FloatArray,
) -> None:
    """Scores proposals.

    Args:
        paths: (P, K, 8) as filled by ``propose``.
        before: Acceleration before them, m/s².
        half_length, half_width: Half size of the ego, metres.
        way: (n, 4) the followed way, columns ``WayCol``.
        margins: (n, 3) the margins beside it, columns ``MarginCol``.
        future: (K, n, 4) the predicted others, columns ``FutureCol``.
        sizes: (n, 2) columns ``SizeCol``.
        out: (P, 5) filled, columns ``ScoreCol``.
    """
    furthest = 0.0
    for p in range(paths.shape[0]):
        path, found = paths[p], out[p]
        steps = first_collision(path, half_length, half_width, future, sizes)
        found[ScoreCol.COLLISION_TIME] = np.inf if steps == path.shape[0] else steps * STEP
        on_road, oncoming = stays_on_road(path, half_length, half_width, way, margins)
        found[ScoreCol.SCORE] = 1.0 if steps == path.shape[0] else 0.0
        if not on_road:
            found[ScoreCol.SCORE] = 0.0
        if oncoming > 6.0:
            found[ScoreCol.SCORE] = 0.0
        elif oncoming > 2.0:
            found[ScoreCol.SCORE] *= 0.5
        driven = path[path.shape[0] - 1, ProposalCol.ARC] - path[0, ProposalCol.ARC]
        found[ScoreCol.PROGRESS] = max(driven, 0.0)
        found[ScoreCol.KEEPS_TIME], found[ScoreCol.IS_COMFORTABLE] = 0.0, 0.0
        if found[ScoreCol.SCORE] > 0.0:
            furthest = max(furthest, found[ScoreCol.PROGRESS])
            if keeps_time_to_collision(path, half_length, half_width, future, sizes):
                found[ScoreCol.KEEPS_TIME] = 1.0
            if is_comfortable(path, before):
                found[ScoreCol.IS_COMFORTABLE] = 1.0
    weights = PROGRESS_WEIGHT + TIME_TO_COLLISION_WEIGHT + COMFORT_WEIGHT
    for p in range(paths.shape[0]):
        found = out[p]
        progress = found[ScoreCol.PROGRESS] / furthest if furthest > _LEAST_PROGRESS else 1.0
        mean = (
            PROGRESS_WEIGHT * progress
            + TIME_TO_COLLISION_WEIGHT * found[ScoreCol.KEEPS_TIME]
            + COMFORT_WEIGHT * found[ScoreCol.IS_COMFORTABLE]
        )
        found[ScoreCol.SCORE] *= mean / weights
