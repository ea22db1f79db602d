"""CARLA Leaderboard's driving score, versions 1.0, 2.0 and 2.1.

Driving score = route completion (per cent) x infraction penalty. In 1.0 and 2.0 the penalty is the
product of a factor for each event; in 2.1 it is 1 / (1 + the sum of their costs). Distance driven
outside the lanes multiplies it in all of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from drivora_service.metrics.infractions import Infractions


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
        scenario_timeout: A scenario that the ego did not get out of in time.
        slowness: Cost of standing throughout a section of the route while the traffic moves.
        summed: Whether costs are added (2.1); else they are factors to multiply, and ``slowness``
            is subtracted from one.
    """

    pedestrian: float
    vehicle: float
    static: float
    red_light: float
    stop_sign: float
    scenario_timeout: float
    slowness: float
    summed: bool


TARIFFS = {
    Version.V1_0: Tariff(
        pedestrian=0.5,
        vehicle=0.6,
        static=0.65,
        red_light=0.7,
        stop_sign=0.8,
        scenario_timeout=1.0,
        slowness=0.0,
        summed=False,
    ),
    Version.V2_0: Tariff(
        pedestrian=0.5,
        vehicle=0.6,
        static=0.65,
        red_light=0.7,
        stop_sign=0.8,
        scenario_timeout=0.7,
        slowness=0.3,
        summed=False,
    ),
    Version.V2_1: Tariff(
        pedestrian=1.0,
        vehicle=0.7,
        static=0.6,
        red_light=0.4,
        stop_sign=0.25,
        scenario_timeout=0.4,
        slowness=0.4,
        summed=True,
    ),
}
"""The tariff of each version. Version 1.0 knows neither slowness nor timeouts of scenarios."""


def infraction_penalty(infractions: Infractions, version: Version) -> float:
    """Returns the penalty for infractions by the rules of a version, 0..1, 1 without any."""
    tariff = TARIFFS[version]
    counts = (
        (infractions.pedestrian, tariff.pedestrian),
        (infractions.vehicle, tariff.vehicle),
        (infractions.static, tariff.static),
        (infractions.red_light, tariff.red_light),
        (infractions.stop_sign, tariff.stop_sign),
        (infractions.scenario_timeout, tariff.scenario_timeout),
    )
    within = 1.0 - infractions.outside
    slowness = [tariff.slowness * (1.0 - pace) for pace in infractions.slow]
    if tariff.summed:
        return within / (1.0 + sum(count * cost for count, cost in counts) + sum(slowness))
    penalty = within
    for count, factor in counts:
        penalty *= factor**count
    for cost in slowness:
        penalty *= 1.0 - cost
    return penalty
