"""The scene of a collision, to which the rules are applied."""

from __future__ import annotations

import math
from dataclasses import dataclass

from shapely.geometry.base import BaseGeometry

from drivora_service.geometry.angles import wrap_angle
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.observations.trace import Col, Role, Trace
from drivora_service.oracles.responsibility.finding import Fault
from drivora_service.oracles.responsibility.impact import Face, Impact
from drivora_service.oracles.responsibility.lane_areas import LaneAreas, intrusion
from drivora_service.oracles.responsibility.lane_chains import (
    find_continuation,
    find_origin,
    reaches,
)
from drivora_service.oracles.responsibility.party import Party
from drivora_service.oracles.responsibility.required_braking import could_brake

ALONG = 1.2
"""Radians from a lane's direction up to which an actor follows it."""

AGAINST = 2.0
"""Radians from a lane's direction from which on an actor faces against it."""

TOO_NEAR = "already too close when the recording started"
"""Why it is undetermined which of two is responsible."""

ASTRAY = 0.2
"""Metres beyond the lanes of its own direction from which on a vehicle has left them."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Scene:
    """The scene of a collision.

    Attributes:
        trace: The run.
        network: Its road network.
        areas: The areas of the network's lanes.
        step: Row of the trace at the contact.
        ego: The ego up to the contact.
        other: The other actor up to the contact.
        impact: The impact.
        standing_speed: m/s up to which an actor stands.
    """

    trace: Trace
    network: RoadNetwork
    areas: LaneAreas
    step: int
    ego: Party
    other: Party
    impact: Impact
    standing_speed: float

    @property
    def other_role(self) -> Role:
        """The role of the other."""
        return self.other.actor.role

    def stands(self, party: Party) -> bool:
        """Returns whether a party stood."""
        return party.speed <= self.standing_speed

    def face(self, party: Party) -> Face:
        """Returns the part of a party that was touched."""
        return self.impact.face if party is self.ego else self.impact.other_face

    def fault_of(self, party: Party) -> Fault:
        """Returns the fault value that blames a party."""
        return Fault.EGO if party is self.ego else Fault.OTHER

    def opposite(self, party: Party) -> Party:
        """Returns the other party."""
        return self.other if party is self.ego else self.ego

    def name(self, party: Party) -> str:
        """Returns the name of a party in a reason."""
        return "the ego" if party is self.ego else "the other"

    @property
    def angle(self) -> float:
        """Angle between the headings of the two, 0 to pi radians."""
        return abs(wrap_angle(self.ego.yaw - self.other.yaw))

    def road_lanes(self) -> tuple[int, ...]:
        """Returns the lanes outside junctions on which the two touched."""
        found = self.areas.drivable_at(self.impact.place)
        return tuple(lane for lane in found if not self.network.lanes[lane].is_internal)

    def lane_chain(self) -> tuple[int, ...]:
        """Returns ``road_lanes``, and before them the lanes by which the two came into these."""
        lanes = self.road_lanes()
        ways = (self.ego.lanes.tolist(), self.other.lanes.tolist())
        return (*lanes, *sorted(find_origin(self.network, lanes, ways)))

    def astray(self, party: Party, k: int = -1) -> float:
        """Returns how far a party was in lanes of the other direction only, metres."""
        row = k % party.count
        place, yaw = party.place(row), float(party.states[row, Col.YAW])
        near = [
            lane
            for lane in self.areas.drivable_at(place, 0.5 * party.actor.length)
            if not self.network.lanes[lane].is_internal
        ]
        turns = {lane: self.areas.turn(lane, place, yaw) for lane in near}
        against = [lane for lane in near if turns[lane] > AGAINST]
        if not against:
            return 0.0
        area = self.areas.union(against)
        own = [lane for lane in near if turns[lane] <= AGAINST]
        if own:
            area = area.difference(self.areas.union(own))
        return intrusion(party.boxes[row], yaw, party.actor.length, party.actor.width, area, yaw)

    def way(self, party: Party) -> BaseGeometry:
        """Returns the area of the lanes that a party drove on and goes on to, up to the other.

        The other may be on the next edge, or inside the junction, already: those of its lanes that
        continue the party's own lane belong to the way.
        """
        touched = {
            lane
            for lane in self.areas.drivable_at(self.impact.place)
            if self.areas.turn(lane, self.impact.place, party.yaw) < ALONG
        }
        driven = {int(lane) for lane in party.lanes if lane >= 0}
        theirs = self.opposite(party).lanes.tolist()
        onwards = find_continuation(self.network, {int(party.lanes[-1])} | touched, theirs)
        # A party that reaches into another lane: the other may always have been there. If its own
        # lane leads there, the ways merge, and the other came in where they do.
        merge = reaches(self.network, driven, touched)
        ways = (party.lanes.tolist(), theirs)
        origin = frozenset() if merge else find_origin(self.network, touched, ways)
        return self.areas.union(touched | driven | onwards | origin)

    def could_brake(self, party: Party, step: int) -> bool:
        """Returns whether a party could have kept clear by braking from a row on."""
        return could_brake(party, self.opposite(party), step)

    def too_fast_to_brake(self, party: Party, step: int, excess: float) -> bool:
        """Returns whether a party could have kept clear from a row on if it had not sped.

        Args:
            party: The party.
            step: Row of the trace.
            excess: Share of the limit by which it must have been faster.
        """
        k = min(max(step - party.first, 0), party.count - 1)
        lane = int(party.lanes[k])
        limit = self.network.lanes[lane].speed_limit if lane >= 0 else math.inf
        speed = math.hypot(party.states[k, Col.VX], party.states[k, Col.VY])
        if speed <= (1.0 + excess) * limit:
            return False
        return not self.could_brake(party, step) and could_brake(
            party, self.opposite(party), step, limit=limit
        )
