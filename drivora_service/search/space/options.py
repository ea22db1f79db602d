"""What of a seed scenario may vary, and how far."""

from __future__ import annotations

from dataclasses import dataclass

from drivora_service.scenario.model import NpcBehavior


@dataclass(frozen=True, slots=True, kw_only=True)
class SpaceOptions:
    """How many actors a candidate has besides the seed's own, and which conditions vary.

    The actors of the seed scenario stay as they are; those of the gene space come on top.

    Attributes:
        egos: Egos in all. 1: the seed's, unchanged. More: every ego, up to this many, is part of
            the gene space (route, start, start time), the first two always present.
        vehicles: NPC vehicles.
        walkers: Walkers that cross an ego's way.
        obstacles: Static objects beside or partly on an ego's way.
        optional: Whether each of these actors may be absent.
        slices: Waypoints that an NPC vehicle's genes set along its path.
        behavior: Of the NPC vehicles.
        weather: Whether the weather varies.
        lights: Whether the times of the traffic lights vary.
        reach: Metres around the egos' routes within which NPC vehicles start.
        paths: Paths that the NPC vehicles choose from, at most.
        max_speed_factor: Greatest wanted speed of an NPC vehicle over its lane's limit.
        max_walker_delay: Seconds until which a walker may start.
        max_ego_delay: Seconds until which an ego may start, where egos vary.
    """

    egos: int = 1
    vehicles: int = 3
    walkers: int = 1
    obstacles: int = 0
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
