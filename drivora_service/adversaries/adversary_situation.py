"""The situation in which an adversary acts: the ego on its route, and everyone around it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

from drivora_service.networks.road_network import Lane, RoadNetwork
from drivora_service.networks.routes.lane_route import LaneRoute
from drivora_service.observations.trace import EgoCol
from drivora_service.scenario.model import Region, Weather
from drivora_service.search.space.driven_path import DrivenPath
from drivora_service.simulation.episode import Episode
from drivora_service.simulation.look import ActorState

EGO = 0
"""Row of the ego against which the adversary acts."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Situation:
    """The present state of an episode as an adversary sees it.

    Attributes:
        time: Seconds.
        ego: The ego.
        others: The other actors in the world.
        network: The road network.
        path: The ego's route.
        arc: Place of the ego on it, metres.
        weather: The present weather.
        region: The part of the network in which actors must be.
        number: Number of the decision, from 0.
    """

    time: float
    ego: ActorState
    others: tuple[ActorState, ...]
    network: RoadNetwork
    path: DrivenPath
    arc: float
    weather: Weather
    region: Region | None
    number: int

    @property
    def lane(self) -> Lane:
        """The lane of the route at the ego's place."""
        return self.lane_at(self.arc)

    def lane_at(self, arc: float) -> Lane:
        """Returns the lane of the route at a place on it."""
        lane, _, _ = self.path.lane_ranges[self.path.range_at(arc)]
        return self.network.lanes[lane]

    def neighbour(self, arc: float, side: int) -> Lane | None:
        """Returns the lane of the same direction beside the route's; side 1 is left, -1 right."""
        lane = self.lane_at(arc)
        index = lane.left if side > 0 else lane.right
        return None if index < 0 else self.network.lanes[index]


def situation_of(episode: Episode, number: int) -> Situation | None:
    """Returns the present situation; ``None`` if the ego is not in the world."""
    plan, look = episode.plan, episode.look()
    ego_id = plan.egos[EGO].ego.id
    ego = next((actor for actor in look.actors if actor.id == ego_id), None)
    if ego is None:
        return None
    path = _path_of(plan.network, plan.egos[EGO].route)
    arc = float(episode.frames(episode.row).ego_values[-1, EGO, EgoCol.ROUTE_S])
    return Situation(
        time=look.time,
        ego=ego,
        others=tuple(actor for actor in look.actors if actor is not ego),
        network=plan.network,
        path=path,
        # An ego that has not started is at the beginning of its route.
        arc=0.0 if math.isnan(arc) else arc,
        weather=episode.weather,
        region=plan.scenario.map_region.region_segment,
        number=number,
    )


@lru_cache(maxsize=64)
def _path_of(network: RoadNetwork, route: LaneRoute) -> DrivenPath:
    """Returns a route as a path; routes are shared."""
    return DrivenPath(network, route)
