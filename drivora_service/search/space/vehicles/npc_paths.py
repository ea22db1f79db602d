"""The paths that NPC vehicles choose from: near the egos' routes, of every relation to them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from drivora_service.errors import SearchError
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.scenario.model import Region
from drivora_service.search.space.driven_path import DrivenPath, plan_walk
from drivora_service.search.space.lane_walks import LaneWalk
from drivora_service.search.space.relations import Relation
from drivora_service.search.space.walk_choice import START_ROOM, find_walks, take_in_turns

PATH_LENGTHS = (60.0, 200.0)
"""Least and greatest length of an NPC vehicle's path, metres. Between them it is that of the
longest ego route, so that the vehicle drives for about as long as the egos."""
_TRAILING_SHARE = 0.1
"""Greatest share of paths from behind an ego: a follower can rarely affect it."""
_LEAST_ROOM = 4.0
_DEAD_END_SHARE = 0.3
"""Share of a path along which its vehicle may start if the road ends too early."""
_LEAST_ROAD = 8.0
"""Metres of road that a start needs: more than the longest vehicle."""
_END_MARGIN = 4.0
"""Metres between starts and the ends of a road, if it is long enough."""


@dataclass(frozen=True, slots=True, kw_only=True)
class NpcPath:
    """A path for an NPC vehicle.

    Attributes:
        path: The path.
        relation: Relation to the egos' routes.
        starts: Arc lengths between which it may start, in order; none is inside a junction.
    """

    path: DrivenPath
    relation: Relation
    starts: tuple[tuple[float, float], ...]

    @property
    def start_room(self) -> float:
        """Total length on which it may start, metres."""
        return sum(high - low for low, high in self.starts)

    def start_at(self, share: float) -> float:
        """Returns the arc length of a share, 0..1, of the places where it may start."""
        left = min(max(share, 0.0), 1.0) * self.start_room
        for low, high in self.starts:
            if left <= high - low:
                return low + left
            left -= high - low
        return self.starts[-1][1]


def find_npc_paths(
    network: RoadNetwork,
    routes: Sequence[DrivenPath],
    *,
    reach: float,
    count: int,
    region: Region | None = None,
) -> tuple[NpcPath, ...]:
    """Chooses paths around the egos' routes.

    At most ``count`` are taken: as many of one relation as of another, as far as they exist, and of
    one relation those that differ most. The order is fixed; neighbours in it have different
    relations.

    Raises:
        SearchError: There is none.
    """
    journey = min(max([route.length for route in routes] + [PATH_LENGTHS[0]]), PATH_LENGTHS[1])
    walks = find_walks(network, routes, reach=reach, length=journey + START_ROOM, most=2 * count)
    most = max(round(_TRAILING_SHARE * count), 1)
    walks[Relation.TRAILING] = walks.get(Relation.TRAILING, [])[:most]

    def path(walk: LaneWalk, relation: Relation) -> NpcPath | None:
        planned = plan_walk(network, walk)
        if planned is None or not planned.is_within(region):
            return None
        starts = _starts(planned, journey)
        room = sum(high - low for low, high in starts)
        if room < _LEAST_ROOM:
            return None
        return NpcPath(path=planned, relation=relation, starts=starts)

    paths = take_in_turns(walks, tuple(Relation), count, path)
    if not paths:
        raise SearchError(
            f"no path for an NPC vehicle was found on {network.name!r} within {reach:g} m of the "
            "egos' routes and in the seed's region; raise `reach`, use no NPC vehicles, or choose "
            "another seed scenario"
        )
    return paths


def _starts(path: DrivenPath, journey: float) -> tuple[tuple[float, float], ...]:
    room = min(START_ROOM, max(path.length - journey, _DEAD_END_SHARE * path.length))
    starts = []
    for lane, begin, end in path.lane_ranges:
        road = path.network.lanes[lane]
        if road.is_internal or road.length < _LEAST_ROAD or begin >= room:
            continue
        margin = min(_END_MARGIN, 0.25 * (end - begin))
        low = begin if begin == 0.0 else begin + margin
        high = min(end - margin, room)
        if high > low:
            starts.append((low, high))
    return tuple(starts)
