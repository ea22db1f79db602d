"""Decoding the genes of an NPC vehicle."""

from __future__ import annotations

import math
from dataclasses import replace

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.networks.routes.route_line import QuickChange
from drivora_service.scenario.model import NpcBehavior, NpcVehicle, RouteEnd
from drivora_service.scenario.models.actor_models import ActorModel
from drivora_service.search.genes import Block
from drivora_service.search.space.actor_starts import Start
from drivora_service.search.space.alike import ABSENT, Decoded
from drivora_service.search.space.driven_path import DrivenPath
from drivora_service.search.space.space_options import SpaceOptions
from drivora_service.search.space.vehicles.npc_waypoints import (
    CHANGE_ROOM,
    LEAST_STEP,
    Stop,
    has_room_beside,
    make_planned_waypoints,
    make_replay_waypoints,
    place_beside,
)
from drivora_service.search.space.vehicles.vehicle_genes import MANOEUVRES, WAITING
from drivora_service.search.space.vehicles.vehicle_places import GenePlaces, VehiclePlace
from drivora_service.search.space.vehicles.vehicle_ways import SpeedGene, VehicleWay

_LEAST_SPACING = 15.0
"""Metres between waypoints, if there is room: enough for a lane change."""
_DIGITS = 3


class VehicleDecoder:
    """Reads one vehicle's genes.

    Attributes:
        genes: Where its genes place it; ``None`` if its start is fixed.
    """

    def __init__(
        self,
        block: Block,
        actor_id: str,
        place: GenePlaces | VehiclePlace,
        options: SpaceOptions,
    ) -> None:
        self.block, self._id, self._options = block, actor_id, options
        self.genes = place if isinstance(place, GenePlaces) else None
        self._fixed = None if isinstance(place, GenePlaces) else place
        names = {gene.name: block.start + i for i, gene in enumerate(block.genes)}
        self._present = names.get("present")
        self._speeds = list(block.indices("speed"))
        self._lanes = list(block.indices("lane"))
        self._manoeuvres = list(block.indices("manoeuvre"))
        self._shifts = list(block.indices("along"))
        self._deceleration = names.get("deceleration")
        self._lateral = names.get("lateral_acceleration")
        self._wait = tuple(names[name] for name in WAITING if name in names)

    def is_present(self, values: FloatArray) -> bool:
        """Returns whether the vehicle is present."""
        return self._present is None or bool(values[self._present] > 0.5)

    def place(self, values: FloatArray) -> VehiclePlace:
        """Returns where it starts, on which path, as which model."""
        if self._fixed is not None:
            return self._fixed
        assert self.genes is not None
        return self.genes.place(values)

    def start(self, values: FloatArray) -> Start:
        """Returns its appearance."""
        place = self.place(values)
        until = 0.0
        if not self._options.slice_time:
            first = self._first(values, place)
        else:
            first, *others = self._timed_stops(values, place, self._options.slice_time)
            until = first.wait if others else math.inf
        return Start(
            pose=place.path.path.at(place.s),
            length=place.model.length,
            width=place.model.width,
            until=until,
            speed=0.0 if until else first.speed,
            path=place.path.path,
            s=place.s,
        )

    def vehicle(self, values: FloatArray) -> NpcVehicle:
        """Returns the vehicle."""
        place = self.place(values)
        path, model, options = place.path.path, place.model, self._options
        if not options.slice_time:
            stops = [self._first(values, place), *self._stops(values, path, model, place.s)]
        else:
            stops = self._timed_stops(values, place, options.slice_time)
        lateral = self._limit(values, self._lateral, options.max_lateral_acceleration)
        if options.behavior is NpcBehavior.REPLAY:
            radius = model.wheelbase / math.tan(model.max_steer)

            def change(speed: float) -> QuickChange:
                return QuickChange(
                    speed=speed, lateral_acceleration=lateral or math.inf, least_radius=radius
                )

            route = make_replay_waypoints(path, stops, None if lateral is None else change)
        else:
            route = make_planned_waypoints(
                path, stops, lambda s, wanted: self._speed(path, model, s, wanted)
            )
        return NpcVehicle(
            id=self._id,
            model=model.name,
            route=route,
            behavior=options.behavior,
            at_end=options.at_end,
            deceleration=self._limit(values, self._deceleration, options.max_deceleration),
            lateral_acceleration=lateral,
        )

    def decode_part(self, values: FloatArray) -> Decoded:
        """Returns the vehicle and its appearance, as ``alike`` compares them."""
        if not self.is_present(values):
            return ABSENT
        return self.vehicle(values), self.start(values)

    def way(self, values: FloatArray) -> VehicleWay:
        """Returns where the vehicle drives, and from where on its genes have an effect."""
        place, options = self.place(values), self._options
        path = place.path.path
        speeds: tuple[SpeedGene, ...] = ()
        # Limits of its own and stops, which are planned within the grip, move the places from which
        # on a speed shows.
        is_plain = options.at_end is RouteEnd.LEAVE and not (
            options.slice_time
            or options.max_wait
            or options.max_deceleration
            or options.max_lateral_acceleration
        )
        if is_plain:
            places, wanted = self._places(values, path, place.s), values[self._speeds]
            speeds = tuple(
                SpeedGene(
                    index=self._speeds[k],
                    after=places[k - 1],
                    before=max(float(wanted[:k].max()), options.min_speed),
                )
                for k in range(1, len(places))
            )
        return VehicleWay(
            block=self.block,
            line=path.line,
            arc=path.arc,
            speeds=speeds,
            places=(*self._lanes, *self._shifts),
        )

    def _limit(self, values: FloatArray, gene: int | None, most: float) -> float | None:
        """Returns a limit of its driving: its gene, or without one the greatest; 0 is none."""
        value = most if gene is None else float(values[gene])
        return round(value, _DIGITS) or None

    def _first(self, values: FloatArray, place: VehiclePlace) -> Stop:
        """Returns the waypoint at the start."""
        wanted = float(values[self._speeds[0]])
        speed = self._speed(place.path.path, place.model, place.s, wanted)
        return Stop(s=place.s, side=0, speed=speed)

    def _speed(self, path: DrivenPath, model: ActorModel, s: float, wanted: float) -> float:
        fastest = min(self._options.max_speed_factor * path.limit_at(s), model.max_speed)
        return max(min(wanted, fastest), self._options.min_speed)

    def _stops(
        self, values: FloatArray, path: DrivenPath, model: ActorModel, begin: float
    ) -> list[Stop]:
        """Returns the waypoints after the start."""
        places = self._places(values, path, begin)
        lanes = values[self._lanes].tolist() if self._lanes else [0.0] * len(places)
        at, seconds = self._decode_wait(values)
        stops = []
        for k, s in enumerate(places):
            before = places[k - 1] if k else begin
            if s - before < 0.5 * LEAST_STEP:
                # The road ends before the last waypoints.
                continue
            behind = places[k + 1] if k + 1 < len(places) else math.inf
            room = min(s - before, behind - s)
            side = int(lanes[k]) if room >= CHANGE_ROOM else 0
            stops.append(
                Stop(
                    s=s,
                    side=side if has_room_beside(path, s, side) else 0,
                    speed=self._speed(path, model, s, float(values[self._speeds[k]])),
                    wait=seconds if k == at else 0.0,
                )
            )
        return stops

    def _decode_wait(self, values: FloatArray) -> tuple[int, float]:
        """Returns the slice at whose waypoint it stands, -1 for none, and for how many seconds."""
        if not self._wait:
            return -1, 0.0
        waits, at, seconds = (float(values[gene]) for gene in self._wait)
        return (int(at) if waits > 0.5 else -1), seconds

    def _timed_stops(self, values: FloatArray, place: VehiclePlace, seconds: float) -> list[Stop]:
        """Returns the waypoints of slices of time, the start included.

        After the last slice it drives on to the end of its path at its last speed, unless it
        stands.
        """
        path, model = place.path.path, place.model
        stops = [Stop(s=place.s, side=0, speed=0.0)]
        wanted_side, stands = 0, False
        for k, gene in enumerate(self._speeds):
            before = stops[-1]
            speed = self._speed(path, model, before.s, float(values[gene]))
            if self._manoeuvres:
                wanted_side += MANOEUVRES[int(values[self._manoeuvres[k]])]
                wanted_side = min(max(wanted_side, -1), 1)
            if len(stops) == 1 and not stops[0].wait:
                stops[0] = before = replace(before, speed=speed)
            stands = speed * seconds < LEAST_STEP
            if stands:
                stops[-1] = replace(before, wait=before.wait + seconds)
            else:
                stops += self._next_stop(
                    path, before, before.s + speed * seconds, wanted_side, speed
                )
        if not stands:
            # A place beside the path keeps from the end of its lane.
            end = path.length - (CHANGE_ROOM if wanted_side else 0.0)
            stops += self._next_stop(path, stops[-1], end, wanted_side, speed)
        if len(stops) == 1:
            # It never drives: a parked vehicle.
            return [replace(stops[0], wait=0.0)]
        return stops

    def _next_stop(
        self, path: DrivenPath, before: Stop, s: float, wanted_side: int, speed: float
    ) -> list[Stop]:
        """Returns the waypoint that is reached at ``s``, or near it; none if the path ends before.

        A lane beside the path is reached where there is room for it.
        """
        s = path.on_road(min(s, path.length), before.s + LEAST_STEP)
        if s - before.s < LEAST_STEP:
            return []
        for side in dict.fromkeys((wanted_side, before.side)):
            room = LEAST_STEP if side == before.side else CHANGE_ROOM
            place = s if side == 0 else place_beside(path, s, side)
            if place is not None and place - before.s >= room:
                return [Stop(s=place, side=side, speed=speed)]
        return [Stop(s=s, side=0, speed=speed)]

    def _places(self, values: FloatArray, path: DrivenPath, begin: float) -> list[float]:
        """Returns the arc lengths of the waypoints: evenly spaced, shifted, in order, on roads.

        None is inside a junction, where lanes overlap and the planner might match it to another
        lane.
        """
        count = len(self._shifts)
        spacing = (path.length - begin) / count
        least = min(_LEAST_SPACING, 0.6 * spacing)
        places: list[float] = []
        last = begin
        for k, shift in enumerate(values[self._shifts].tolist()):
            wanted = begin + (k + 1) * spacing + shift
            wanted = min(max(wanted, last + least), path.length - (count - 1 - k) * least)
            last = path.on_road(wanted, last + min(least, LEAST_STEP))
            places.append(last)
        return places
