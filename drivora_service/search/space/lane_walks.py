"""Walks along lanes from a place, in every permitted direction."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from drivora_service.networks.road_network import Lane, RoadNetwork
from drivora_service.networks.routes.lane_graph import lane_graph
from drivora_service.networks.routes.tight_turns import tight_turns

MAX_CHOICES = 3
"""Number of junctions at which a walk takes all directions; then it takes the straightest."""

_BEHIND_JUNCTION = 6.0
"""Metres by which a walk that would end inside a junction continues after it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LaneWalk:
    """Lanes that follow one another, those inside junctions included.

    Attributes:
        lanes: Indices of the lanes.
        start_s: Arc length on the first lane where it begins, metres.
        end_s: Arc length on the last lane where it ends, metres.
    """

    lanes: tuple[int, ...]
    start_s: float
    end_s: float


def walks_from(network: RoadNetwork, lane: int, s: float, length: float) -> Iterator[LaneWalk]:
    """Yields the walks of ``length`` metres from a place on a lane, in a fixed order.

    A walk never changes lanes, passes a lane twice or turns more tightly than a car can; it is
    shorter if the road ends. None ends inside a junction.
    """
    lengths = lane_graph(network).lengths
    waiting: list[tuple[tuple[int, ...], float, int]] = [((lane,), lengths[lane] - s, 0)]
    while waiting:
        lanes, walked, choices = waiting.pop()
        here = network.lanes[lanes[-1]]
        if walked >= length and not here.is_internal:
            end = max(lengths[here.index] - (walked - length), _least_end(lanes, lengths, s))
            yield LaneWalk(lanes=lanes, start_s=s, end_s=end)
            continue
        ways = [way for way in _ways(network, here) if way not in lanes]
        if not ways:
            if not here.is_internal:
                yield LaneWalk(lanes=lanes, start_s=s, end_s=lengths[here.index])
            continue
        divides = len(ways) > 1
        if divides and choices >= MAX_CHOICES:
            ways = ways[:1]
        choices += divides
        waiting.extend(((*lanes, way), walked + lengths[way], choices) for way in reversed(ways))


def _least_end(lanes: tuple[int, ...], lengths: tuple[float, ...], s: float) -> float:
    """Returns the least arc length on the last lane at which a walk may end."""
    if len(lanes) == 1:
        return s
    return min(_BEHIND_JUNCTION, 0.5 * lengths[lanes[-1]])


def _ways(network: RoadNetwork, lane: Lane) -> list[int]:
    """Returns the lanes after a lane, the straightest first."""
    links = [link for link in lane.connections if network.lanes[link.to_lane].drivable]
    turns = tight_turns(network)
    links = [link for link in links if (lane.index, link.to_lane) not in turns]
    links.sort(key=lambda link: "sRLrlt".find(link.direction))
    return list(dict.fromkeys(link.to_lane for link in links))
