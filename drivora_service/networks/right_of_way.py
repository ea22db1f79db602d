"""Right of way inside junctions, from the network's own table."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from xml.etree import ElementTree

from drivora_service.networks.road_network import RoadNetwork


@dataclass(frozen=True, slots=True, kw_only=True)
class Movement:
    """A way through a junction.

    Attributes:
        junction: Id of the junction.
        lanes: Internal lanes in order.
        incoming: Lane before the junction, or -1.
        foes: Internal lanes (last of their movement) that cross or merge with this one.
        yields_to: Those of ``foes`` that have the right of way.
        gives_way_on: Crossings of the junction whose walkers go first.
    """

    junction: str
    lanes: tuple[int, ...]
    incoming: int
    foes: tuple[int, ...]
    yields_to: tuple[int, ...]
    gives_way_on: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class RightOfWay:
    """All movements of a network.

    by_lane: Movement of each internal lane.
    before: Lanes that lead into a lane, by lane.
        before: Lanes that lead into a lane, by lane.
    """

    by_lane: dict[int, Movement]
    before: dict[int, tuple[int, ...]]


@lru_cache(maxsize=128)
def right_of_way(network: RoadNetwork) -> RightOfWay:
    """Returns the right-of-way table of a network, read once."""
    into: dict[int, list[int]] = {}
    # In networks with sidewalks, the walking areas and crossings of a junction form a ring.
    drivable = [lane for lane in network.lanes if lane.drivable]
    for lane in drivable:
        for connection in lane.connections:
            if network.lanes[connection.to_lane].drivable:
                into.setdefault(connection.to_lane, []).append(lane.index)
    ways = {lane.id: lane.index for lane in drivable}
    crossings = {
        lane.id: lane.index for lane in network.lanes if lane.walkable and not lane.drivable
    }
    by_lane: dict[int, Movement] = {}
    for _, element in ElementTree.iterparse(network.path):
        if element.tag != "junction" or element.get("type") == "internal":
            continue
        names = element.get("intLanes", "").split()
        last = [ways.get(name, -1) for name in names]
        walked = [crossings.get(name, -1) for name in names]
        for request in element.findall("request"):
            link = int(request.get("index", "-1"))
            if not 0 <= link < len(last) or last[link] < 0:
                continue
            chain = [last[link]]
            while chain[0] in into and network.lanes[into[chain[0]][0]].is_internal:
                chain.insert(0, into[chain[0]][0])
            movement = Movement(
                junction=element.get("id", ""),
                lanes=tuple(chain),
                incoming=into.get(chain[0], [-1])[0],
                foes=_decode_lanes(request.get("foes", ""), last),
                yields_to=_decode_lanes(request.get("response", ""), last),
                gives_way_on=_decode_lanes(request.get("response", ""), walked),
            )
            for index in chain:
                by_lane[index] = movement
        element.clear()
    return RightOfWay(by_lane=by_lane, before={lane: tuple(lanes) for lane, lanes in into.items()})


def _decode_lanes(bits: str, lanes: list[int]) -> tuple[int, ...]:
    """Returns the lanes whose bit is set; the rightmost character is link 0."""
    return tuple(
        lane for lane, bit in zip(lanes, reversed(bits), strict=False) if bit == "1" and lane >= 0
    )
