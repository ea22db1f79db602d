"""The common checks of documents and scenarios, against the network and the catalogues."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace

from drivora_service.errors import Problem, UnknownName
from drivora_service.known_names import unknown_name_message
from drivora_service.networks.catalogue import NetworkLookup
from drivora_service.networks.projection import nearest_lane_position
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.scenario import fields
from drivora_service.scenario.checks.agent_checks import check_agents
from drivora_service.scenario.checks.drafts import Doubts
from drivora_service.scenario.checks.patch_checks import check_patches, place_patches
from drivora_service.scenario.checks.place_checks import OffLanePlace, check_places
from drivora_service.scenario.checks.placed_actors import PlacedActor, place_actors
from drivora_service.scenario.checks.route_checks import RouteCheck, check_route
from drivora_service.scenario.checks.start_overlaps import StartPose, check_overlaps
from drivora_service.scenario.conversion import background_count, frame_of, region
from drivora_service.scenario.documents import ScenarioDocument
from drivora_service.scenario.entities import (
    BackgroundTrafficDocument,
    EgoDocument,
    NpcVehicleDocument,
    NpcWaypointDocument,
)
from drivora_service.scenario.frames import FrameTransform
from drivora_service.scenario.model import (
    EgoVehicle,
    NpcBehavior,
    NpcVehicle,
    Region,
    RouteEnd,
    Scenario,
    Waypoint,
)
from drivora_service.scenario.plain_data import pointer


def check_driving(content: ScenarioDocument | Scenario) -> Iterator[Problem]:
    """Yields a problem for each part that a vehicle could not follow.

    SUMO drives vehicles of behavior ``sumo`` by its own models and removes them at their
    destinations; a parked vehicle stands anyway, and never drives on.
    """
    vehicles: Sequence[NpcVehicleDocument | NpcVehicle] = content.npc_vehicles
    for index, npc in enumerate(vehicles):
        place = ("npc_vehicles", index)
        if npc.behavior is NpcBehavior.SUMO:
            if npc.at_end is not RouteEnd.LEAVE:
                yield _not_for_sumo((*place, "at_end"), f"at_end {npc.at_end.value!r}")
            for name in ("deceleration", "lateral_acceleration"):
                value = getattr(npc, name)
                if value is not None:
                    yield _not_for_sumo((*place, name), f"{name} {value:g} m/s²")
        waypoints: Sequence[NpcWaypointDocument | Waypoint] = npc.route
        for number, waypoint in enumerate(waypoints):
            if waypoint.wait is None:
                continue
            at = (*place, "route", number, "wait")
            if npc.behavior is NpcBehavior.SUMO:
                yield _not_for_sumo(at, f"wait {waypoint.wait:g} s")
            elif len(npc.route) == 1:
                message = (
                    f"found wait {waypoint.wait:g} s at the only waypoint; such a vehicle is "
                    "parked and stays: leave `wait` out, or add the waypoint to which it drives on"
                )
                yield Problem(pointer=pointer(at), code="parked_waits", message=message)


def _not_for_sumo(place: tuple[str | int, ...], found: str) -> Problem:
    message = (
        f"found {found}, but SUMO drives a vehicle of behavior sumo by its own models and removes "
        "it at its destination; use behavior reactive or replay, or leave it out"
    )
    return Problem(pointer=pointer(place), code="not_for_sumo", message=message)


@dataclass(frozen=True, slots=True, kw_only=True)
class Checked:
    """The result of the checks.

    Attributes:
        network: The road network; ``None`` if the town is unknown.
        actors: Actors in document order.
        snapped: Waypoints of egos that were off the lanes.
    """

    problems: tuple[Problem, ...]
    network: RoadNetwork | None
    actors: tuple[PlacedActor, ...]
    snapped: tuple[OffLanePlace, ...]


def check(
    content: ScenarioDocument | Scenario,
    networks: NetworkLookup,
    agents: Collection[str] | None,
    driven_by: str,
    doubts: Doubts,
    routes: RouteCheck = check_route,
) -> Checked:
    """Checks a well-formed document, or a scenario within the bounds of one.

    Args:
        content: Document or scenario to check.
        networks: Catalogue with its town.
        agents: As for :func:`~drivora_service.scenario.validation.validate_data`.
        driven_by: The same.
        doubts: Places that are not reported, since they are unknown.
        routes: Checks the route of an actor.

    Raises:
        NetworkError: The town's network file cannot be read.
    """
    problems = check_agents(content, agents, driven_by)
    network: RoadNetwork | None = None
    if not doubts.cover("/map_region/town"):
        try:
            network = networks.get(content.map_region.town)
        except UnknownName as error:
            problems.append(_unknown_town(content.map_region.town, error))
    frame = FrameTransform() if network is None else frame_of(content, network)
    actors, model_problems = place_actors(content, frame)
    problems += model_problems
    problems += _check_speeds(content, actors)
    problems += check_driving(content)
    problems += _check_weather_changes(content)
    snapped: list[OffLanePlace] = []
    if network is not None:
        if not doubts.cover("/frame"):
            segment = region(content.map_region.region_segment, frame)
            place_problems, snapped = _check_on_network(actors, network, segment, doubts, routes)
            problems += place_problems
            problems += check_patches(place_patches(content, frame), network, segment)
        problems += _check_lights(content, network)
        problems += _check_background(content, network)
    return Checked(
        problems=tuple(problem for problem in problems if not doubts.cover(problem.pointer)),
        network=network,
        actors=actors,
        snapped=tuple(snapped),
    )


def _check_on_network(
    actors: Sequence[PlacedActor],
    network: RoadNetwork,
    segment: Region | None,
    doubts: Doubts,
    routes: RouteCheck,
) -> tuple[list[Problem], list[OffLanePlace]]:
    problems, snapped = check_places(actors, network, segment)
    lost = {problem.pointer for problem in problems if problem.code == "off_network"}
    poses: list[StartPose] = []
    for actor in actors:
        places = range(len(actor.places))
        if lost and any(actor.place_pointer(index) in lost for index in places):
            continue
        route_problems, pose = routes(snap_start(actor, snapped, network), network)
        problems += route_problems
        if pose is not None and not doubts.touch(actor.pointer):
            poses.append(pose)
    problems += check_overlaps(poses)
    return problems, snapped


def _unknown_town(town: str, error: UnknownName) -> Problem:
    return Problem(
        pointer="/map_region/town",
        code="unknown_town",
        message=(
            f"{unknown_name_message('town', town, error.known)}. Import it with "
            f"`drivora networks import FILE --name {town}` from a .net.xml, .xodr or .osm file"
        ),
    )


def _check_speeds(
    content: ScenarioDocument | Scenario, actors: Sequence[PlacedActor]
) -> list[Problem]:
    egos: Sequence[EgoDocument | EgoVehicle] = content.ego_vehicles
    problems = []
    for ego, actor in zip(egos, actors, strict=False):
        limit = None if actor.model is None else actor.model.max_speed
        speed = float(ego.initial_speed)
        if limit is not None and speed > limit:
            message = f"found {speed} m/s; {ego.model} reaches {limit} m/s"
            place = f"{actor.pointer}/initial_speed"
            problems.append(Problem(pointer=place, code="too_fast", message=message))
    return problems


def _check_weather_changes(content: ScenarioDocument | Scenario) -> list[Problem]:
    times = [change.time for change in content.weather_changes]
    return [
        Problem(
            pointer=pointer(("weather_changes", index, "time")),
            code="wrong_order",
            message=f"found {time} s after a change at {before} s; the changes must be in the "
            "order of their times, each at another time",
        )
        for index, (before, time) in enumerate(itertools.pairwise(times), 1)
        if time <= before
    ]


def _check_lights(content: ScenarioDocument | Scenario, network: RoadNetwork) -> list[Problem]:
    unknown = [name for name in content.traffic_lights.junctions if name not in network.programs]
    if not unknown:
        return []
    known = sorted(network.programs)
    listing = ", ".join(known[:20]) + (", ..." if len(known) > 20 else "")
    return [
        Problem(
            pointer=pointer(("traffic_lights", "junctions", junction)),
            code="unknown_traffic_light",
            message=f"found {junction[:80]!r}; {network.name} has "
            f"{listing if known else 'no traffic lights'}",
        )
        for junction in unknown
    ]


def _check_background(content: ScenarioDocument | Scenario, network: RoadNetwork) -> list[Problem]:
    background = content.background_traffic
    if not isinstance(background, BackgroundTrafficDocument) or background.density is None:
        return []
    count = background_count(background, network)
    if count <= fields.MAX_BACKGROUND_VEHICLES:
        return []
    message = (
        f"found {background.density} vehicles a kilometre, which are {count} on {network.name}; "
        f"at most {fields.MAX_BACKGROUND_VEHICLES} are allowed"
    )
    return [Problem(pointer="/background_traffic/density", code="too_many", message=message)]


def snap_start(
    actor: PlacedActor, snapped: Sequence[OffLanePlace], network: RoadNetwork
) -> PlacedActor:
    """Moves the start of an ego off the lanes onto the nearest lane."""
    if not any(off.actor is actor and off.place == 0 for off in snapped):
        return actor
    start = actor.places[0]
    near = nearest_lane_position(network, start.x, start.y, heading=start.yaw)
    if near is None:
        return actor
    x, y, _ = network.lanes[near.lane].position_at(near.s)
    return replace(actor, places=(replace(start, x=x, y=y), *actor.places[1:]))
