"""Lanes that continue each other: an actor that keeps its way changes from id to id.

Networks cut a road into edges, junctions and their internal lanes. An actor that drives straight on
gets another lane every few metres, which is no manoeuvre. So the rules ask whether an actor came
into a *chain* of lanes, never into the lane that happens to lie under the contact.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import lru_cache
from types import MappingProxyType

from drivora_service.networks.road_network import RoadNetwork

_HOPS = 4
"""Connections in a row by which a lane may lead to another: a junction has up to three internal
lanes one after the other."""

_SHORT = 4.0
"""Metres up to which a lane may be missing in a record: an actor at speed is there for one step."""


def find_continuation(
    network: RoadNetwork, lanes: Iterable[int], driven: Iterable[int]
) -> frozenset[int]:
    """Returns those of the driven lanes that lie downstream of some lanes, one after the other.

    Args:
        network: The network.
        lanes: Lanes from which the chain goes on; -1 is none.
        driven: Lanes on which the actor ahead drove.
    """
    ahead = set(driven) - {*lanes, -1}
    found: set[int] = set()
    edge, passed = set(lanes) - {-1}, set[int]()
    while edge and ahead:
        following = {
            connection.to_lane for one in edge for connection in network.lanes[one].connections
        }
        reached = following & ahead
        found |= reached
        ahead -= reached
        # Roads lead back to where they began: only what is too short to be recorded is passed over.
        passed |= edge
        short = {one for one in following if network.lanes[one].length <= _SHORT}
        edge = (reached | short) - passed
    return frozenset(found)


def reaches(network: RoadNetwork, lanes: Iterable[int], targets: Iterable[int]) -> bool:
    """Returns whether some lanes are among others, or lead to one of them."""
    edge, wanted = set(lanes) - {-1}, set(targets)
    for _ in range(_HOPS):
        if edge & wanted:
            return True
        edge = {connection.to_lane for one in edge for connection in network.lanes[one].connections}
    return bool(edge & wanted)


def find_origin(
    network: RoadNetwork, lanes: Iterable[int], ways: tuple[Iterable[int], Iterable[int]]
) -> frozenset[int]:
    """Returns the driven lanes upstream of some lanes, up to where two ways merge.

    Where two actors came into the same lane from different ones, their ways merge, and which of
    them came into it first is a question. Where one of them, or both, came from the same lane, that
    is still the way it keeps.

    Args:
        network: The network.
        lanes: Lanes at a place.
        ways: The lanes on which each of the two drove.
    """
    before = _predecessors(network)
    first, second = (set(way) - {-1} for way in ways)
    found: set[int] = set()
    edge = sorted(set(lanes))
    while edge:
        origins: set[int] = set()
        for lane in edge:
            came_from = before.get(lane, frozenset())
            one, two = came_from & first, came_from & second
            if one and two and one != two:
                continue
            origins |= one | two
        origins -= found | set(lanes)
        found |= origins
        edge = sorted(origins)
    return frozenset(found)


@lru_cache(maxsize=16)
def _predecessors(network: RoadNetwork) -> Mapping[int, frozenset[int]]:
    """Returns the lanes from which each lane is entered."""
    before: dict[int, set[int]] = {}
    for lane in network.lanes:
        for connection in lane.connections:
            before.setdefault(connection.to_lane, set()).add(lane.index)
    return MappingProxyType({lane: frozenset(found) for lane, found in before.items()})
