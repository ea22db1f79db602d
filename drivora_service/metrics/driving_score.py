"""CARLA Leaderboard's driving score, versions 1.0, 2.0 and 2.1.

Driving score = route completion (per cent) x infraction penalty. In 1.0 and 2.0 the penalty is the
product of a factor for each event; in 2.1 it is 1 / (1 + the sum of their costs). Distance driven
outside the lanes multiplies it in all of them. Scenario timeouts have no oracle here and are not
counted.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from drivora_service.metrics.judgement import Judgement
from drivora_service.metrics.route_completion import route_completion
from drivora_service.metrics.traffic_pace import minimum_speed
from drivora_service.observations.run_view import EgoView
from drivora_service.observations.trace import Role

STANDING_SPEED = 0.1
"""m/s below which an ego is not charged with a collision."""


class Version(StrEnum):
    """Version of the Leaderboard's score."""

    V1_0 = "1.0"
    V2_0 = "2.0"
    V2_1 = "2.1"


@dataclass(frozen=True, slots=True, kw_only=True)
class Tariff:
    """The costs of events.

    Attributes:
        pedestrian: Collision with a walker.
        vehicle: Collision with a vehicle.
        static: Collision with an obstacle.
        red_light: A red light run.
        stop_sign: A stop sign run.
        slowness: Cost of a standstill throughout, compared with the surrounding traffic.
        summed: Whether costs are added (2.1); else they are factors to multiply, and ``slowness``
            is subtracted from one.
    """

    pedestrian: float
    vehicle: float
    static: float
    red_light: float
    stop_sign: float
    slowness: float
    summed: bool


TARIFFS = {
    Version.V1_0: Tariff(
        pedestrian=0.5,
        vehicle=0.6,
        static=0.65,
        red_light=0.7,
        stop_sign=0.8,
        slowness=0.0,
        summed=False,
    ),
    Version.V2_0: Tariff(
        pedestrian=0.5,
        vehicle=0.6,
        static=0.65,
        red_light=0.7,
        stop_sign=0.8,
        slowness=0.3,
        summed=False,
    ),
    Version.V2_1: Tariff(
        pedestrian=1.0,
        vehicle=0.7,
        static=0.6,
        red_light=0.4,
        stop_sign=0.25,
        slowness=0.4,
        summed=True,
    ),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class DrivingScore:
    """The score of one ego.

    Attributes:
        score: Per cent.
        completion: Per cent.
        penalty: 0..1, 1 without infractions.
    """

    score: float
    completion: float
    penalty: float


def driving_score(ego: EgoView, judgement: Judgement, version: Version) -> DrivingScore | None:
    """Scores an ego; ``None`` if the verdicts that the score needs are missing."""
    completion = route_completion(ego, judgement)
    if completion is None:
        return None
    penalty = 1.0
    if ego.count:
        found = infraction_penalty(ego, judgement, TARIFFS[version])
        if found is None:
            return None
        penalty = found
    return DrivingScore(score=completion * penalty, completion=completion, penalty=penalty)


def infraction_penalty(ego: EgoView, judgement: Judgement, tariff: Tariff) -> float | None:
    """Returns the penalty for an ego's infractions by a tariff."""
    collisions = judgement.violations("collision")
    red_lights = judgement.violations("red_light")
    stop_signs = judgement.violations("stop_sign")
    outside = judgement.by("lane_keeping")
    if collisions is None or red_lights is None or stop_signs is None or outside is None:
        return None
    costs = [tariff.red_light] * len(red_lights) + [tariff.stop_sign] * len(stop_signs)
    for collision in collisions:
        if collision.evidence["ego_speed"] < STANDING_SPEED:
            continue
        role = Role(collision.evidence["counterpart_role"])
        if role is Role.NPC_WALKER:
            costs.append(tariff.pedestrian)
        else:
            costs.append(tariff.static if role is Role.NPC_OBSTACLE else tariff.vehicle)
    pace = minimum_speed(ego)
    slowness = 0.0 if pace is None else tariff.slowness * (1.0 - pace / 100.0)
    within = 1.0 - float(outside[0].evidence["share"])
    if tariff.summed:
        return within / (1.0 + sum(costs) + slowness)
    penalty = within * (1.0 - slowness)
    for factor in costs:
        penalty *= factor
    return penalty
