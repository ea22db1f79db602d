"""The variable parts of a seed scenario, and their ranges."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from drivora_service.scenario.model import NpcBehavior, RouteEnd

LEAST_SPEED = 2.0
"""m/s: an ego behind a vehicle at this speed still arrives within 0.8 s a metre, its time limit."""


class VehicleStarts(StrEnum):
    """Whether model, path and start of the NPC vehicles vary."""

    FREE = "free"
    """They do."""
    FIXED = "fixed"
    """They are chosen once for the seed scenario, near its first ego."""


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
        starts: Whether model, path and start of the NPC vehicles vary; fixed, only what they do
            varies.
        slice_time: Seconds of a slice: a waypoint is where the speed of its slice leads in that
            time, and at a speed near 0 the vehicle stands for it. 0: waypoints are spread over the
            path.
        lane_changes: Whether NPC vehicles change lanes.
        at_end: What NPC vehicles do at the end of their way.
        max_wait: Longest time for which an NPC vehicle stands at one of its waypoints, seconds; 0:
            none does.
        max_deceleration: Greatest planned braking of an NPC vehicle, m/s²; 0: as documents have it
            if they do not tell.
        max_lateral_acceleration: Greatest lateral acceleration of an NPC vehicle in bends and lane
            changes, m/s²; 0: as documents have it if they do not tell.
        min_speed: Least desired speed of an NPC vehicle, m/s.
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
    starts: VehicleStarts = VehicleStarts.FREE
    slice_time: float = 0.0
    lane_changes: bool = True
    at_end: RouteEnd = RouteEnd.LEAVE
    max_wait: float = 0.0
    max_deceleration: float = 0.0
    max_lateral_acceleration: float = 0.0
    min_speed: float = LEAST_SPEED
    max_speed_factor: float = 1.3
    max_walker_delay: float = 15.0
    max_ego_delay: float = 15.0
