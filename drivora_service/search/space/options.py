"""The variable parts of a seed scenario, and their ranges."""

from __future__ import annotations

from dataclasses import dataclass

from drivora_service.scenario.model import NpcBehavior


@dataclass(frozen=True, slots=True, kw_only=True)
class SpaceOptions:
    """The numbers of actors besides the seed's own, and the conditions that vary.

    The actors of the seed scenario are unchanged; those of the gene space are added.

    Attributes:
        egos: Number of egos. 1: the seed's, unchanged. More: every ego, up to this many, is part of
            the gene space (route, start, start time), the first two always present.
        vehicles: Number of NPC vehicles.
        walkers: Number of walkers that cross an ego's way.
        obstacles: Number of static objects beside or partly on an ego's way.
        patches: Number of slippery patches on an ego's way.
        optional: Whether each of these actors and patches may be absent.
        slices: Number of waypoints along an NPC vehicle's path.
        behavior: Behavior of the NPC vehicles.
        weather: Whether the weather varies.
        lights: Whether the times of the traffic lights vary.
        reach: Metres around the egos' routes within which NPC vehicles start.
        paths: Greatest number of paths that the NPC vehicles choose from.
        max_speed_factor: Greatest desired speed of an NPC vehicle over its lane's limit.
        max_walker_delay: Latest start time of a walker, seconds.
        max_ego_delay: Latest start time of an ego, if egos vary, seconds.
    """

    egos: int = 1
    vehicles: int = 3
    walkers: int = 1
    obstacles: int = 0
    patches: int = 0
    optional: bool = False
    slices: int = 5
    behavior: NpcBehavior = NpcBehavior.REACTIVE
    weather: bool = True
    lights: bool = False
    reach: float = 80.0
    paths: int = 40
    max_speed_factor: float = 1.3
    max_walker_delay: float = 15.0
    max_ego_delay: float = 15.0
