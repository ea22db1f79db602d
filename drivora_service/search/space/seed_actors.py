"""The seed scenario's own actors: their starts and ids."""

from __future__ import annotations

import math

from drivora_service.networks.road_network import RoadNetwork
from drivora_service.scenario.checks.placed_actors import place_actors
from drivora_service.scenario.checks.route_checks import check_route
from drivora_service.scenario.frames import FrameTransform
from drivora_service.scenario.model import Scenario
from drivora_service.search.space.actor_starts import Start
from drivora_service.search.space.driven_path import Pose


def seed_starts(seed: Scenario, network: RoadNetwork) -> tuple[Start, ...]:
    """Returns the starts of the seed's vehicles, walkers and obstacles; egos are left out."""
    actors, _ = place_actors(seed, FrameTransform())
    starts = []
    for actor in actors:
        if actor.is_ego or actor.model is None:
            continue
        _, pose = check_route(actor, network)
        if pose is None:
            continue
        moves = len(actor.places) > 1
        starts.append(
            Start(
                pose=Pose(x=pose.x, y=pose.y, yaw=pose.yaw),
                length=actor.model.length,
                width=actor.model.width,
                appears=actor.start_time,
                until=actor.start_time if moves else math.inf,
                speed=(actor.places[0].speed or 0.0) if moves else 0.0,
            )
        )
    return tuple(starts)


class ActorNames:
    """Ids for new actors and patches, different from those of the seed's."""

    def __init__(self, seed: Scenario) -> None:
        self._used = {
            actor.id
            for actors in (
                seed.ego_vehicles,
                seed.npc_vehicles,
                seed.npc_walkers,
                seed.npc_obstacles,
                seed.friction_patches,
            )
            for actor in actors
        }

    def take_name(self, name: str) -> str:
        """Takes and returns ``name`` or, if it is taken, ``name.1``, ``name.2`` and so on."""
        found, number = name, 0
        while found in self._used:
            number += 1
            found = f"{name}.{number}"
        self._used.add(found)
        return found
