"""Scores of simulated proposals, by nuPlan's terms as in PDM-Closed; compiled.

Source: Dauner, Hallgarten, Geiger, Chitta, *Parting with Misconceptions about Learning-based
Vehicle Motion Planning* (2023), and nuPlan's metrics. The terms that multiply: no collision at
fault, drivable area, driving direction. The averaged terms: progress, time to collision,
comfort.
"""

from __future__ import annotations

import math

import numpy as np

from drivora_service.agents.pdm_closed.forecast import STEP
from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.geometry.boxes import overlap_depth

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
    dx, dy = there[0] - x, there[1] - y
    reach = half_length + half_width + 0.5 * (size[0] + size[1])
    if abs(dx) > reach or abs(dy) > reach:
        return False
    depth = overlap_depth(
        dx, dy, yaw, 2.0 * half_length, 2.0 * half_width, there[2], size[0], size[1]
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
        if _touches(
            path[0, 0], path[0, 1], path[0, 2], half_length, half_width, future[0, j], sizes[j]
        ):
            continue
        for k in range(1, steps):
            x, y, yaw = path[k, 0], path[k, 1], path[k, 2]
            if not _touches(
                x, y, yaw, half_length + _CLEARANCE, half_width + _CLEARANCE, future[k, j],
                sizes[j],
            ):  # fmt: skip
                continue
            if path[k, 3] < _STANDS:
                break
            ahead = (future[k, j, 0] - x) * math.cos(yaw) + (future[k, j, 1] - y) * math.sin(yaw)
            if ahead < 0.0 and future[k, j, 3] > _STANDS:
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
        x, y, yaw, speed = path[k, 0], path[k, 1], path[k, 2], path[k, 3]
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
                if (there[0] - px) * cos + (there[1] - py) * sin > 0.0:
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
    at, end = 0, way[way.shape[0] - 1, 2] - 0.1
    for k in range(path.shape[0]):
        s, side = path[k, 6], path[k, 7]
        if s >= end:
            break
        if k == 0:
            at = int(np.searchsorted(way[:, 2], s))
        while at < way.shape[0] - 2 and way[at + 1, 2] < s:
            at += 1
        at = min(max(at, 0), way.shape[0] - 2)
        line_yaw = math.atan2(way[at + 1, 1] - way[at, 1], way[at + 1, 0] - way[at, 0])
        turned = path[k, 2] - line_yaw
        across = half_width * abs(math.cos(turned)) + half_length * abs(math.sin(turned))
        outside = max(side + across - margins[at, 0], across - side - margins[at, 1])
        if k == 0:
            allowed = max(outside, 0.0) + _SLACK
        elif outside > allowed:
            return False, oncoming
        if k > 0 and side > margins[at, 2]:
            oncoming += path[k, 3] * STEP
    return True, oncoming


@compiled
def is_comfortable(path: FloatArray, before: float) -> bool:
    """Returns whether a proposal keeps nuPlan's limits of comfort.

    Args:
        path: (K, 8) the proposal.
        before: Acceleration before it, m/s².
    """
    pull, turn = before, 0.0
    for k in range(path.shape[0] - 1):
        asked = path[k, 4] if path[k, 3] > _STANDS else 0.0
        if asked > _MAX_PULL or asked < -_MAX_BRAKING:
            return False
        if k > 0 and abs(asked - pull) / STEP > _MAX_JERK and path[k, 3] > 2.0 * _STANDS:
            return False
        rate = (path[k + 1, 2] - path[k, 2]) / STEP
        if abs(rate) > _MAX_YAW_RATE or abs(rate * path[k, 3]) > _MAX_SIDE:
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
        way: (n, 4) the followed way.
        margins: (n, 3) the margins beside it.
        future: (K, n, 4) the predicted others.
        sizes: (n, 2) metres.
        out: (P, 5) filled: score 0..1, seconds to the first collision at fault or inf, metres of
            progress, 1 if the time to collision is kept, 1 if it is comfortable.
    """
    furthest = 0.0
    for p in range(paths.shape[0]):
        path, found = paths[p], out[p]
        steps = first_collision(path, half_length, half_width, future, sizes)
        found[1] = np.inf if steps == path.shape[0] else steps * STEP
        on_road, oncoming = stays_on_road(path, half_length, half_width, way, margins)
        found[0] = 1.0 if steps == path.shape[0] else 0.0
        if not on_road:
            found[0] = 0.0
        if oncoming > 6.0:
            found[0] = 0.0
        elif oncoming > 2.0:
            found[0] *= 0.5
        found[2] = max(path[path.shape[0] - 1, 6] - path[0, 6], 0.0)
        found[3], found[4] = 0.0, 0.0
        if found[0] > 0.0:
            furthest = max(furthest, found[2])
            if keeps_time_to_collision(path, half_length, half_width, future, sizes):
                found[3] = 1.0
            if is_comfortable(path, before):
                found[4] = 1.0
    weights = PROGRESS_WEIGHT + TIME_TO_COLLISION_WEIGHT + COMFORT_WEIGHT
    for p in range(paths.shape[0]):
        found = out[p]
        progress = found[2] / furthest if furthest > _LEAST_PROGRESS else 1.0
        mean = (
            PROGRESS_WEIGHT * progress
            + TIME_TO_COLLISION_WEIGHT * found[3]
            + COMFORT_WEIGHT * found[4]
        )
        found[0] *= mean / weights
