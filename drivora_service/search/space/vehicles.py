"""Genes of an NPC vehicle, and their decoding."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

from drivora_service.geometry.arrays import FloatArray
from drivora_service.scenario.actor_models import ActorKind, ActorModel, actor_model
from drivora_service.scenario.model import NpcBehavior, NpcVehicle, Waypoint
from drivora_service.scenario.route_checks import JOIN_DISTANCE
from drivora_service.search.genes import Block, Gene
from drivora_service.search.space.alike import ABSENT, Decoded
from drivora_service.search.space.driven_path import DrivenPath
from drivora_service.search.space.layout import choice, number, presence, whole
from drivora_service.search.space.npc_paths import NpcPath
from drivora_service.search.space.options import SpaceOptions
from drivora_service.search.space.starts import Start
from drivora_service.search.space.vehicle_ways import SpeedGene, VehicleWay

MODELS = (
    "vehicle.nissan.micra",
    "vehicle.lincoln.mkz_2017",
    "vehicle.volkswagen.t2",
    "vehicle.tesla.cybertruck",
    "vehicle.mercedes.sprinter",
    "vehicle.carlamotors.carlacola",
    "vehicle.yamaha.yzf",
)
"""Small and large cars, vans, a truck and a motorcycle, all narrower than any lane."""
LEAST_SPEED = 2.0
"""m/s: an ego behind a vehicle at this speed still arrives within 0.8 s a metre, its time limit."""
MAX_SHIFT = 12.0
"""Greatest move of a waypoint along the path, metres."""
_LEAST_SPACING = 15.0
"""Metres between waypoints, if there is room: enough for a lane change."""
_LEAST_STEP = 2.0
"""Least distance between waypoints, metres."""
_CHANGE_ROOM = 12.0
"""Metres that a waypoint on the neighbouring lane keeps from the waypoints before and behind it,
and from the ends of its lane, so that it can be reached and left on the way."""
_TURN = 1.3
"""Ratio of lengths up to which a straight line may stand for a path."""
_REPLAY_SPACING = 4.0
"""Metres between the waypoints of a vehicle that follows straight lines between them."""


def vehicle_genes(options: SpaceOptions, paths: Sequence[NpcPath]) -> list[Gene]:
    """Returns the genes of an NPC vehicle that chooses from ``paths``."""
    slices = range(options.slices)
    limit = max(float(path.path.route.speed_limits.max()) for path in paths)
    fastest = max(options.max_speed_factor * limit, LEAST_SPEED)
    leftmost = int(any(_neighbour(path.path, 1) for path in paths))
    rightmost = -int(any(_neighbour(path.path, -1) for path in paths))
    return [
        presence(optional=options.optional),
        choice("model", len(MODELS)),
        choice("path", len(paths)),
        number("start", 0.0, 1.0),
        *[number(f"speed_{k}", LEAST_SPEED, fastest, "m/s") for k in slices],
        *[whole(f"lane_{k}", rightmost, leftmost) for k in slices],
        *[number(f"along_{k}", -MAX_SHIFT, MAX_SHIFT, "m") for k in slices],
    ]


def _neighbour(path: DrivenPath, side: int) -> bool:
    """Returns whether any lane of a path has a neighbour on a side."""
    lanes = [path.network.lanes[lane] for lane, _, _ in path.lane_ranges]
    return any((lane.left if side > 0 else lane.right) >= 0 for lane in lanes)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Stop:
    """A planned waypoint: arc length on the path, lane to the side (-1, 0, 1), desired speed."""

    s: float
    side: int
    speed: float


class VehicleDecoder:
    """Reads one vehicle's genes."""

    def __init__(
        self, block: Block, actor_id: str, paths: Sequence[NpcPath], options: SpaceOptions
    ) -> None:
        self.block, self._id = block, actor_id
        self._paths, self._options = paths, options
        self._models = tuple(actor_model(ActorKind.VEHICLE, name) for name in MODELS)
        self._present = block.start
        self._model = block.index("model")
        self.path_gene, self.shift_gene = block.index("path"), block.index("start")
        self._speeds = list(block.indices("speed"))
        self._lanes = list(block.indices("lane"))
        self._shifts = list(block.indices("along"))

    def is_present(self, values: FloatArray) -> bool:
        """Returns whether the vehicle is present."""
        return bool(values[self._present] > 0.5)

    def path(self, values: FloatArray) -> NpcPath:
        """Returns the chosen path."""
        return self._paths[int(values[self.path_gene])]

    def shift_room(self, values: FloatArray) -> float:
        """Returns the metres that the start gene moves it by, from 0 to 1."""
        return self.path(values).start_room

    def start(self, values: FloatArray) -> Start:
        """Returns its appearance."""
        chosen, model = self.path(values), self._model_of(values)
        s = chosen.start_at(float(values[self.shift_gene]))
        return Start(
            pose=chosen.path.at(s),
            length=model.length,
            width=model.width,
            speed=self._speed(chosen.path, model, s, float(values[self._speeds[0]])),
            path=chosen.path,
            s=s,
        )

    def vehicle(self, values: FloatArray) -> NpcVehicle:
        """Returns the vehicle."""
        chosen, model = self.path(values), self._model_of(values)
        path = chosen.path
        begin = chosen.start_at(float(values[self.shift_gene]))
        stops = self._stops(values, path, model, begin)
        wanted = float(values[self._speeds[0]])
        first = _Stop(s=begin, side=0, speed=self._speed(path, model, begin, wanted))
        if self._options.behavior is NpcBehavior.REPLAY:
            route = _drawn(path, [first, *stops])
        else:
            route = _joined(
                path, [first, *stops], lambda s, wanted: self._speed(path, model, s, wanted)
            )
        return NpcVehicle(
            id=self._id, model=model.name, route=route, behavior=self._options.behavior
        )

    def decoded(self, values: FloatArray) -> Decoded:
        """Returns the vehicle and its appearance, as ``alike`` compares them."""
        if not self.is_present(values):
            return ABSENT
        return self.vehicle(values), self.start(values)

    def way(self, values: FloatArray) -> VehicleWay:
        """Returns where the vehicle drives, and from where on its genes have an effect."""
        path = self.path(values).path
        begin = self.path(values).start_at(float(values[self.shift_gene]))
        places = self._places(values, path, begin)
        speeds = values[self._speeds]
        return VehicleWay(
            block=self.block,
            line=path.line,
            arc=path.arc,
            speeds=tuple(
                SpeedGene(
                    index=self._speeds[k],
                    after=places[k - 1],
                    before=max(float(speeds[:k].max()), LEAST_SPEED),
                )
                for k in range(1, len(places))
            ),
            places=(*self._lanes, *self._shifts),
        )

    def _model_of(self, values: FloatArray) -> ActorModel:
        return self._models[int(values[self._model])]

    def _speed(self, path: DrivenPath, model: ActorModel, s: float, wanted: float) -> float:
        fastest = min(self._options.max_speed_factor * path.limit_at(s), model.max_speed)
        return max(min(wanted, fastest), LEAST_SPEED)

    def _stops(
        self, values: FloatArray, path: DrivenPath, model: ActorModel, begin: float
    ) -> list[_Stop]:
        """Returns the waypoints after the start."""
        places = self._places(values, path, begin)
        stops = []
        for k, s in enumerate(places):
            before = places[k - 1] if k else begin
            if s - before < 0.5 * _LEAST_STEP:
                # The road ends before the last waypoints.
                continue
            behind = places[k + 1] if k + 1 < len(places) else math.inf
            room = min(s - before, behind - s)
            side = int(values[self._lanes[k]]) if room >= _CHANGE_ROOM else 0
            stops.append(
                _Stop(
                    s=s,
                    side=side if _has_room_beside(path, s, side) else 0,
                    speed=self._speed(path, model, s, float(values[self._speeds[k]])),
                )
            )
        return stops

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
            last = path.on_road(wanted, last + min(least, _LEAST_STEP))
            places.append(last)
        return places


def _has_room_beside(path: DrivenPath, s: float, side: int) -> bool:
    """Returns whether a waypoint on the lane to the side can be reached and left again."""
    if side == 0:
        return False
    index, low, high = path.lane_ranges[path.range_at(s)]
    lane = path.network.lanes[index]
    if (lane.left if side > 0 else lane.right) < 0:
        return False
    return low + _CHANGE_ROOM <= s <= high - _CHANGE_ROOM


def _offset(path: DrivenPath, stop: _Stop) -> float:
    """Returns the metres to the left of the path at which a waypoint lies."""
    if stop.side == 0:
        return 0.0
    own = path.network.lanes[path.lane_ranges[path.range_at(stop.s)][0]]
    other = path.network.lanes[own.left if stop.side > 0 else own.right]
    return stop.side * 0.5 * (own.width + other.width)


def _joined(
    path: DrivenPath, stops: Sequence[_Stop], allowed: Callable[[float, float], float]
) -> tuple[Waypoint, ...]:
    """Returns waypoints between which the planner reproduces the path.

    Args:
        path: Their path.
        stops: The waypoints placed by genes.
        allowed: Returns the speed at an arc length, given the desired one.
    """
    route = [_waypoint(path, stops[0])]
    for before, stop in pairwise(stops):
        route.extend(
            path.at(s).waypoint(allowed(s, stop.speed)) for s in _ties(path, before.s, stop.s)
        )
        route.append(_waypoint(path, stop))
    return tuple(route)


def _ties(path: DrivenPath, begin: float, end: float) -> list[float]:
    """Returns the places to pass between two waypoints, so that the path is unique.

    For waypoints on roads that are not adjacent, it is the middle of the longest road between them;
    for waypoints so near to one another that a straight line would join them although the path
    turns, the middle of the turn.
    """
    first, last = path.range_at(begin), path.range_at(end)
    roads = [
        (high - low, 0.5 * (low + high))
        for lane, low, high in path.lane_ranges[first + 1 : last]
        if not path.network.lanes[lane].is_internal
    ]
    if roads:
        return [max(roads)[1]]
    here, there = path.at(begin), path.at(end)
    straight = math.hypot(there.x - here.x, there.y - here.y)
    if straight <= JOIN_DISTANCE and end - begin > _TURN * straight + _LEAST_STEP:
        return [0.5 * (begin + end)]
    return []


def _drawn(path: DrivenPath, stops: Sequence[_Stop]) -> tuple[Waypoint, ...]:
    """Returns waypoints so near to one another that straight lines between them follow the path."""
    route = [_waypoint(path, stops[0])]
    for before, stop in pairwise(stops):
        count = max(math.ceil((stop.s - before.s) / _REPLAY_SPACING), 1)
        here, there = _offset(path, before), _offset(path, stop)
        for step in range(1, count + 1):
            share = step / count
            aside = here + (there - here) * 0.5 * (1.0 - math.cos(math.pi * share))
            s = before.s + share * (stop.s - before.s)
            route.append(path.at(s).beside(aside).waypoint(stop.speed))
    return tuple(route)


def _waypoint(path: DrivenPath, stop: _Stop) -> Waypoint:
    return path.at(stop.s).beside(_offset(path, stop)).waypoint(stop.speed)
