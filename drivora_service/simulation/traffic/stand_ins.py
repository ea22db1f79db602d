"""Stand-ins: SUMO vehicles for actors that reach into a lane from another lane or off the road.

A vehicle in SUMO is on one lane, that of its front bumper, and extends back along it by its length.
So SUMO's drivers see a wreck across two lanes in only one of them, and do not see a parked vehicle
that reaches in from the verge, while they stop for an actor that only touches their lane. Standing
actors, and all walkers, are therefore treated as boxes: where the box differs from SUMO's lane, the
actor itself is removed from SUMO's lanes (it stays at its place), and on every lane that it reaches
into stands a vehicle that covers the part under the box. Stand-ins exist in SUMO only: they have no
row, agents and followers do not see them, and they are not recorded.

On the lanes inside a junction a standing vehicle also stops traffic that crosses its lane behind
or before it. There, only actors that do not drive off again have stand-ins.

With sublanes (SL2015), removing a vehicle from its lanes crashes SUMO 1.28 with a segmentation
fault. There, walkers, obstacles and parked vehicles are never on lanes, and vehicles that have
driven stay as SUMO placed them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import NamedTuple

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.networks.road_network import Lane, RoadNetwork
from drivora_service.observations.trace import Col
from drivora_service.simulation.motion.step_kernels import PlacementCol
from drivora_service.simulation.sumo import MovedActor, SumoWorld
from drivora_service.simulation.traffic.footprint import Box, Overlap, lanes_under

_SETTLED = 1.0
"""Seconds for which a vehicle that may drive on must stand; fixed actors count at once."""
_ALIGNED = 0.3
"""Radians from its lane up to which a vehicle lies along it, as SUMO assumes."""
_ROUNDING = 0.25
"""Metres; lengths of stand-ins are multiples of it, so that a moving walker needs few."""
_ARRIVAL_ZONE = 1.0
"""Metres before the end of a lane that stay free: SUMO would take a stand-in there as arrived."""


@lru_cache(maxsize=4)
def _lanes_before(network: RoadNetwork) -> Mapping[int, tuple[int, ...]]:
    """Returns the indices of the drivable lanes that lead to a lane, by its index."""
    found: dict[int, tuple[int, ...]] = {}
    for lane in network.lanes:
        for link in lane.connections:
            if lane.drivable:
                found[link.to_lane] = (*found.get(link.to_lane, ()), lane.index)
    return found


class _StandIn(NamedTuple):
    """A vehicle in SUMO that stands for a part of an actor; ``length`` in metres."""

    id: str
    length: float


@dataclass(slots=True, eq=False)
class _Stance:
    """The state of a moved actor.

    Attributes:
        stood: Steps for which it has stood.
        seen: Whether its box has been checked since it last moved.
        held: Its stand-ins by lane index.
    """

    stood: int = 0
    seen: bool = False
    held: dict[int, _StandIn] = field(default_factory=dict)


class StandIns:
    """The stand-ins of all actors that the service moves.

    Attributes:
        fixed: Rows of actors that never drive on: wrecks, parked vehicles, obstacles.
        reserved: Rows that SUMO will drive: they stay on their lanes.
    """

    def __init__(
        self, sumo: SumoWorld, network: RoadNetwork, step_length: float, *, sublanes: bool
    ) -> None:
        self._sumo = sumo
        self._sublanes = sublanes
        self._network = network
        self._patience = math.ceil(_SETTLED / step_length - 1e-9)
        self._made = 0
        self.reserved: set[int] = set()
        self.fixed: set[int] = set()
        self._stances: dict[int, _Stance] = {}
        self._before = _lanes_before(network)

    def tend(
        self,
        actors: Sequence[MovedActor],
        placements: Sequence[Sequence[float]],
        frame: FloatArray,
    ) -> None:
        """Updates the stand-ins before SUMO steps.

        Args:
            actors: All actors that the service moves now.
            placements: As for ``SumoWorld.place``.
            frame: (N, 9) the next frame for SUMO.
        """
        for actor in actors:
            row = actor.row
            moved = placements[row][PlacementCol.MOVED] != 0.0
            if moved and not actor.watched:
                continue
            never_drives = actor.is_walker or (self._sublanes and row in self.fixed)
            if row in self.reserved or (self._sublanes and not never_drives):
                continue
            stance = self._stances.get(row)
            if stance is None:
                stance = self._stances[row] = _Stance()
            if never_drives:
                if moved or not stance.seen:
                    stance.seen = True
                    actor.off_lanes = True
                    self._stand(stance, self._under(actor, frame))
            elif moved:
                if stance.stood:
                    self._let_go(actor, stance)
            else:
                stance.stood += 1
                actor.watched = True
                if not stance.seen and (row in self.fixed or stance.stood >= self._patience):
                    stance.seen = True
                    self._settle(actor, stance, frame)

    def forget(self, row: int) -> None:
        """Removes the stand-ins of an actor that leaves, or that SUMO drives from now on."""
        stance = self._stances.pop(row, None)
        if stance is not None:
            self._stand(stance, ())

    def fix(self, row: int) -> None:
        """Marks an actor as never driving on, and has it checked again; not with sublanes."""
        if self._sublanes:
            return
        self.fixed.add(row)
        self.reserved.discard(row)
        stance = self._stances.get(row)
        if stance is not None:
            stance.seen = False

    def _let_go(self, actor: MovedActor, stance: _Stance) -> None:
        stance.stood, stance.seen = 0, False
        actor.watched = False
        if actor.off_lanes:
            actor.off_lanes = False
            self._stand(stance, ())

    def _settle(self, actor: MovedActor, stance: _Stance, frame: FloatArray) -> None:
        """Removes a standing vehicle or obstacle from its lane if its box differs from that."""
        under = self._under(actor, frame)
        lanes = self._network.lanes
        if actor.row not in self.fixed and any(lanes[one.lane].is_internal for one in under):
            return
        known = "" if actor.off_lanes else self._sumo.lane_of(actor.id)
        yaw = float(frame[actor.row, Col.YAW])
        expected = [
            lanes[one.lane].id for one in under if math.cos(one.heading - yaw) > math.cos(_ALIGNED)
        ]
        if (
            not actor.off_lanes
            and len(expected) == len(under)
            and expected == [known] * bool(known)
        ):
            return
        actor.off_lanes = True
        self._stand(stance, under)

    def _under(self, actor: MovedActor, frame: FloatArray) -> tuple[Overlap, ...]:
        """Returns the stretches of lanes under an actor that traffic reaches first."""
        x, y, yaw = frame[actor.row, : Col.YAW + 1].tolist()
        height = float(frame[actor.row, Col.Z])
        box = Box(x, y, yaw, 2.0 * actor.half_length, actor.width)
        under = lanes_under(self._network, box, height)
        if len(under) < 2:
            return under
        lanes = {one.lane for one in under}
        # The continuation of a blocked lane needs no stand-in, unless other lanes lead
        # there.
        return tuple(
            one
            for one in under
            if not self._before.get(one.lane) or not lanes.issuperset(self._before[one.lane])
        )

    def _stand(self, stance: _Stance, under: Sequence[Overlap]) -> None:
        """Puts stand-ins on the given stretches, and removes the actor's others."""
        wanted = {one.lane: one for one in under}
        for lane_index in [lane for lane in stance.held if lane not in wanted]:
            self._sumo.remove(stance.held.pop(lane_index).id)
        for lane_index, one in wanted.items():
            lane = self._network.lanes[lane_index]
            scale = lane.length / float(lane.arc[-1])
            begin, end = one.begin * scale, one.end * scale
            last = lane.length - (
                0.1 if lane.is_internal else min(_ARRIVAL_ZONE, 0.5 * lane.length)
            )
            length = max(math.ceil((end - begin) / _ROUNDING) * _ROUNDING, _ROUNDING)
            held = stance.held.get(lane_index)
            if held is not None and held.length != length:
                self._sumo.remove(held.id)
                held = None
            if held is None:
                edges = self._edges(lane)
                if not edges:
                    continue
                held = _StandIn(f"stand-in:{self._made}", length)
                self._made += 1
                stance.held[lane_index] = held
                self._sumo.add_stand_in(held.id, edges, length=length, width=lane.width)
            # Its rear is where the box begins, or as near as the lane allows.
            self._sumo.move_stand_in(held.id, lane.id, min(begin + length, last))

    def _edges(self, lane: Lane) -> tuple[str, ...]:
        """Returns a route for a stand-in on a lane; empty for a dead end."""
        if not lane.is_internal:
            return (lane.edge_id,)
        first, last = lane, lane
        while first.is_internal:
            before = self._before.get(first.index)
            if not before:
                return ()
            first = self._network.lanes[before[0]]
        while last.is_internal:
            if not last.connections:
                return ()
            last = self._network.lanes[last.connections[0].to_lane]
        return (first.edge_id, last.edge_id)
