"""Infractions of an ego, as CARLA Leaderboard counts them."""

from __future__ import annotations

import math
from dataclasses import dataclass

from drivora_service.metrics.judgement import Judgement
from drivora_service.metrics.traffic_pace import slow_sections
from drivora_service.observations.run_view import EgoView
from drivora_service.observations.trace import Role
from drivora_service.oracles.verdict import Verdict

STANDING_SPEED = 0.1
"""m/s below which an ego is not charged with a collision."""

SAME_PLACE = 5.0
"""Metres from the last counted collision within which others are part of it."""

SAME_ACTOR = 5.0
"""Seconds after a counted collision within which the same actor is not counted again."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Infractions:
    """What an ego is charged with.

    Attributes:
        pedestrian: Collisions with walkers.
        vehicle: Collisions with vehicles.
        static: Collisions with obstacles.
        red_light: Red lights run.
        stop_sign: Stop signs run.
        scenario_timeout: Blockings that the Leaderboard removes after four minutes. Nothing is
            removed here, so runs have none: an ego that is blocked for good ends.
        slow: The pace of each section of the route in which the ego was slower than the traffic, as
            a share of the traffic's.
        outside: Share of the driven distance that was outside the lanes.
    """

    pedestrian: int = 0
    vehicle: int = 0
    static: int = 0
    red_light: int = 0
    stop_sign: int = 0
    scenario_timeout: int = 0
    slow: tuple[float, ...] = ()
    outside: float = 0.0


def infractions_of(ego: EgoView, judgement: Judgement) -> Infractions | None:
    """Returns the infractions of an ego; ``None`` if a verdict that they need is missing."""
    if not ego.count:
        return Infractions()
    collisions = counted_collisions(judgement)
    red_lights = judgement.violations("red_light")
    stop_signs = judgement.violations("stop_sign")
    keeping = judgement.by("lane_keeping")
    if collisions is None or red_lights is None or stop_signs is None or keeping is None:
        return None
    roles = [Role(collision.evidence["counterpart_role"]) for collision in collisions]
    walkers, obstacles = roles.count(Role.NPC_WALKER), roles.count(Role.NPC_OBSTACLE)
    driven = float(ego.moved.sum())
    outside = float(keeping[0].evidence["distance"])
    return Infractions(
        pedestrian=walkers,
        vehicle=len(roles) - walkers - obstacles,
        static=obstacles,
        red_light=len(red_lights),
        stop_sign=len(stop_signs),
        slow=slow_sections(ego),
        outside=min(outside / driven, 1.0) if driven > 0.0 else 0.0,
    )


def counted_collisions(judgement: Judgement) -> tuple[Verdict, ...] | None:
    """Returns the collisions that the Leaderboard counts; ``None`` if they were not judged.

    Not counted are those of an ego that stood, those within ``SAME_PLACE`` of the last counted one
    as long as the ego has not left that circle, and those with the same actor within
    ``SAME_ACTOR``. The oracle reports an actor once, so that a later second touch never counts.
    """
    collisions = judgement.violations("collision")
    if collisions is None:
        return None
    counted: list[Verdict] = []
    for collision in sorted(collisions, key=lambda verdict: verdict.time or 0.0):
        if collision.evidence["ego_speed"] < STANDING_SPEED:
            continue
        if not counted or not _same(counted[-1], collision):
            counted.append(collision)
    return tuple(counted)


def _same(last: Verdict, collision: Verdict) -> bool:
    elapsed = (collision.time or 0.0) - (last.time or 0.0)
    if last.counterpart == collision.counterpart and elapsed <= SAME_ACTOR:
        return True
    places = (last.location, collision.location)
    return None not in places and math.dist(*places) <= SAME_PLACE  # type: ignore[arg-type]  # neither is None
