"""CARLA Leaderboard's driving scores."""

from __future__ import annotations

import math

import numpy as np

from tests.recomputation.boxes import impact_speed
from tests.recomputation.recording import Drive, Recording
from tests.recomputation.routes import Progress, traffic_pace
from tests.recomputation.speeds import stretches
from tests.recomputation.surfaces import outside_lanes

FACTORS = {"npc_walker": 0.5, "npc_obstacle": 0.65, "vehicle": 0.6, "red": 0.7, "stop": 0.8}
COSTS = {"npc_walker": 1.0, "npc_obstacle": 0.6, "vehicle": 0.7, "red": 0.4, "stop": 0.25}

LEAST_DISTANCE = 1.0
LEAST_TIME = 0.15
"""Metres and seconds that a stay outside the lanes must last to count."""


def penalties(
    run: Recording,
    drive: Drive,
    progress: Progress,
    touched: dict[str, int],
    reds: int,
    stops: int,
    margin: float = 0.5,
) -> dict[str, float]:
    """Returns the infraction penalty of each version, 0..1.

    Args:
        run: The run.
        drive: The ego's part of it.
        progress: On its route.
        touched: Step of each collision, by the other actor's id.
        reds: Red lights run.
        stops: Stop signs run.
        margin: Metres beyond the lanes that count as within.
    """
    events = ["red"] * reds + ["stop"] * stops + charged(run, drive, touched)
    slow = [1.0 - pace for pace in traffic_pace(run, drive, progress, 4) if pace < 1.0]
    stays = stretches(outside_lanes(run.head["network"], drive, margin))
    wrong = sum(
        distance
        for first, last in stays
        if (distance := float(drive.moved[first : last + 1].sum())) >= LEAST_DISTANCE
        and (last + 1 - first) * run.step_length >= LEAST_TIME - 1e-9
    )
    driven = float(drive.moved.sum())
    within = 1.0 - wrong / driven if wrong else 1.0
    product = math.prod(FACTORS[event] for event in events) * within
    return {
        "1_0": product,
        "2_0": product * math.prod(1.0 - 0.3 * cost for cost in slow),
        "2_1": within / (1.0 + sum(COSTS[event] for event in events) + 0.4 * sum(slow)),
    }


def charged(run: Recording, drive: Drive, touched: dict[str, int]) -> list[str]:
    """Returns the kind of each collision that is counted.

    Not those of an ego that stands, and of several within 5 m the first one.
    """
    roles = {actor["id"]: actor["role"] for actor in run.head["actors"]}
    kinds: list[str] = []
    place: tuple[float, float] | None = None
    for other, step in sorted(touched.items(), key=lambda item: item[1]):
        k = step - drive.first
        here = (float(drive.x[k]), float(drive.y[k]))
        if impact_speed(run, drive, step, other) < 0.1:
            continue
        if place is not None and math.dist(place, here) <= 5.0:
            continue
        place, role = here, roles[other]
        kinds.append(role if role in ("npc_walker", "npc_obstacle") else "vehicle")
    return kinds


def mean(values: list[float]) -> float:
    """Returns the mean of the egos' values."""
    return float(np.mean(values))
