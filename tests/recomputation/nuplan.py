"""nuPlan's closed-loop score."""

from __future__ import annotations

import itertools

import numpy as np

from tests.recomputation.recording import Drive, Recording
from tests.recomputation.speeds import limits
from tests.recomputation.surfaces import lane_headings
from tests.recomputation.town import read_town

WEIGHTS = {
    "progress_to_free_flow": 5,
    "time_to_collision": 5,
    "speed_limit": 4,
    "comfort": 2,
}


def direction(run: Recording, drive: Drive) -> float:
    """Scores the greatest distance against the lane within a second: 2 m and 6 m."""
    town = run.head["network"]
    lanes = read_town(town).lanes
    headings = lane_headings(town, drive)
    along = np.zeros(drive.count)
    for k in range(1, drive.count):
        if drive.lanes[k] and not lanes[drive.lanes[k]].inside:
            dx, dy = drive.x[k] - drive.x[k - 1], drive.y[k] - drive.y[k - 1]
            along[k] = dx * np.cos(headings[k]) + dy * np.sin(headings[k])
    rows = round(1.0 / run.step_length)
    worst = max(-float(along[max(k - rows + 1, 0) : k + 1].sum()) for k in range(drive.count))
    return 1.0 if worst <= 2.0 else 0.5 if worst <= 6.0 else 0.0


def speed_limit(run: Recording, drive: Drive) -> float | None:
    """Scores the metres that the ego was too fast by the time that it drove, by trapezes."""
    allowed = limits(run.head["network"], drive)
    if drive.count < 2 or np.isnan(allowed).all():
        return None
    over = [
        0.0 if np.isnan(limit) else max(float(speed - limit), 0.0)
        for speed, limit in zip(drive.speed, allowed, strict=True)
    ]
    metres = sum(0.5 * (a + b) * run.step_length for a, b in itertools.pairwise(over))
    return max(0.0, 1.0 - metres / (2.23 * (drive.count - 1) * run.step_length))


def no_collision(run: Recording, at_fault: list[str]) -> float:
    """Scores the actors that were hit at fault."""
    roles = {actor["id"]: actor["role"] for actor in run.head["actors"]}
    kinds = [roles[other] for other in at_fault]
    objects = kinds.count("npc_obstacle")
    # Each kind has a score of its own: 1 - hits / (allowed + 1), and they multiply.
    return (1.0 if len(kinds) == objects else 0.0) * max(0.0, 1.0 - objects / 2.0)


def whole_score(parts: dict[str, float | None]) -> float | None:
    """Returns the score of all parts."""
    names = ("no_at_fault_collision", "drivable_area", "driving_direction", "making_progress")
    multipliers = [parts[name] for name in names]
    if any(value == 0.0 for value in multipliers):
        return 0.0
    if any(value is None for value in parts.values()):
        return None
    mean = sum(w * (parts[name] or 0.0) for name, w in WEIGHTS.items()) / sum(WEIGHTS.values())
    return float(np.prod([value or 0.0 for value in multipliers])) * mean
