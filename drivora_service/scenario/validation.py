"""Checks a document against its road network and the catalogues; gives the scenario to run.

Nothing that passes may fail later for a reason that the document shows.
"""

from __future__ import annotations

import difflib
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

from drivora_service.errors import InvalidDocument, Problem, UnknownName
from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.networks.projection import nearest_lane_position
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.scenario import fields
from drivora_service.scenario.conversion import (
    DEFAULT_AGENT,
    background_count,
    frame_of,
    region,
    to_scenario,
)
from drivora_service.scenario.documents import ScenarioDocument
from drivora_service.scenario.frames import FrameTransform
from drivora_service.scenario.model import Scenario
from drivora_service.scenario.place_checks import OffLanePlace, check_places
from drivora_service.scenario.placed_actors import PlacedActor, place_actors
from drivora_service.scenario.plain_data import pointer
from drivora_service.scenario.problems import duplicate_ids, in_document_order
from drivora_service.scenario.route_checks import check_route
from drivora_service.scenario.start_overlaps import StartPose, check_overlaps


@dataclass(frozen=True, slots=True, kw_only=True)
class ValidScenario:
    """A scenario that can be run.

    Attributes:
        network: The road network that it takes place on.
        notes: What was interpreted on the way, for people: snapped points, agents by default.
    """

    scenario: Scenario
    network: RoadNetwork
    notes: tuple[str, ...]


def validate_document(
    document: ScenarioDocument, networks: NetworkCatalogue, agents: Collection[str]
) -> ValidScenario:
    """Checks a document and converts it.

    Args:
        document: What ``parse_document`` gave.
        networks: Where towns are looked up.
        agents: Names of the agents that exist.

    Raises:
        InvalidDocument: With every problem, in document order. Where the town is unknown, what
            depends on the road network is not checked.
        NetworkError: The town's network file cannot be read.
    """
    problems = duplicate_ids(document.model_dump())
    problems += _check_agents(document, agents)
    notes = _agent_notes(document)
    network: RoadNetwork | None = None
    try:
        network = networks.get(document.map_region.town)
    except UnknownName as error:
        problems.append(_unknown_town(document.map_region.town, error))
    frame = FrameTransform() if network is None else frame_of(document, network)
    actors, model_problems = place_actors(document, frame)
    problems += model_problems
    problems += _check_speeds(document, actors)
    snapped: list[OffLanePlace] = []
    if network is not None:
        network_problems, snapped = _check_on_network(document, actors, network, frame)
        problems += network_problems
    if problems or network is None:
        raise InvalidDocument(in_document_order(problems, document.model_dump()))
    scenario = to_scenario(document, network)
    egos = tuple(
        replace(ego, route=_snap_start(actor, snapped, network).places)
        for ego, actor in zip(scenario.ego_vehicles, actors, strict=False)
    )
    scenario = replace(scenario, ego_vehicles=egos)
    notes += [_snap_note(place) for place in snapped]
    return ValidScenario(scenario=scenario, network=network, notes=tuple(notes))


def _check_on_network(
    document: ScenarioDocument,
    actors: Sequence[PlacedActor],
    network: RoadNetwork,
    frame: FrameTransform,
) -> tuple[list[Problem], list[OffLanePlace]]:
    segment = region(document.map_region.region_segment, frame)
    problems, snapped = check_places(actors, network, segment)
    lost = {problem.pointer for problem in problems if problem.code == "off_network"}
    poses: list[StartPose] = []
    for actor in actors:
        if any(actor.place_pointer(index) in lost for index in range(len(actor.places))):
            continue
        route_problems, pose = check_route(_snap_start(actor, snapped, network), network)
        problems += route_problems
        if pose is not None:
            poses.append(pose)
    problems += check_overlaps(poses)
    problems += _check_lights(document, network)
    problems += _check_background(document, network)
    return problems, snapped


def _unknown_town(town: str, error: UnknownName) -> Problem:
    known = ", ".join(error.known) if error.known else "none"
    return Problem(
        pointer="/map_region/town",
        code="unknown_town",
        message=(
            f"found town {town!r}, which is not in the catalogue; known: {known}. Import it with "
            f"`drivora networks import FILE --name {town}` from a .net.xml, .xodr or .osm file"
        ),
    )


def _check_agents(document: ScenarioDocument, agents: Collection[str]) -> list[Problem]:
    problems = []
    for index, ego in enumerate(document.ego_vehicles):
        name = ego.agent_name
        if name is None or name in agents:
            continue
        key: tuple[str, ...] = ("config_path",) if ego.agent is None else ("agent", "name")
        close = difflib.get_close_matches(name, sorted(agents), n=3) or sorted(agents)
        problems.append(
            Problem(
                pointer=pointer(("ego_vehicles", index, *key)),
                code="unknown_agent",
                message=f"found agent {name!r}, which is not in the catalogue; known: "
                f"{', '.join(close)}. See `drivora agents list`",
            )
        )
    return problems


def _agent_notes(document: ScenarioDocument) -> list[str]:
    return [
        f"ego {ego.id!r} names no agent; {DEFAULT_AGENT!r} drives it"
        for ego in document.ego_vehicles
        if ego.agent_name is None
    ]


def _check_speeds(document: ScenarioDocument, actors: Sequence[PlacedActor]) -> list[Problem]:
    problems = []
    for ego, actor in zip(document.ego_vehicles, actors, strict=False):
        limit = None if actor.model is None else actor.model.max_speed
        if limit is not None and ego.initial_speed > limit:
            problems.append(
                Problem(
                    pointer=f"{actor.pointer}/initial_speed",
                    code="too_fast",
                    message=f"found {ego.initial_speed} m/s; {ego.model} reaches {limit} m/s",
                )
            )
    return problems


def _check_lights(document: ScenarioDocument, network: RoadNetwork) -> list[Problem]:
    known = sorted(network.programs)
    listing = ", ".join(known[:20]) + (", ..." if len(known) > 20 else "")
    return [
        Problem(
            pointer=pointer(("traffic_lights", "junctions", junction)),
            code="unknown_traffic_light",
            message=f"found {junction[:80]!r}; {network.name} has "
            f"{listing if known else 'no traffic lights'}",
        )
        for junction in document.traffic_lights.junctions
        if junction not in network.programs
    ]


def _check_background(document: ScenarioDocument, network: RoadNetwork) -> list[Problem]:
    background = document.background_traffic
    if background is None or background.density is None:
        return []
    count = background_count(background, network)
    if count <= fields.MAX_BACKGROUND_VEHICLES:
        return []
    message = (
        f"found {background.density} vehicles a kilometre, which are {count} on {network.name}; "
        f"at most {fields.MAX_BACKGROUND_VEHICLES} are allowed"
    )
    return [Problem(pointer="/background_traffic/density", code="too_many", message=message)]


def _snap_start(
    actor: PlacedActor, snapped: Sequence[OffLanePlace], network: RoadNetwork
) -> PlacedActor:
    """Moves the start of an ego that lies beside the lanes onto the nearest."""
    if not any(off.actor is actor and off.place == 0 for off in snapped):
        return actor
    start = actor.places[0]
    near = nearest_lane_position(network, start.x, start.y, heading=start.yaw)
    if near is None:
        return actor
    x, y, _ = network.lanes[near.lane].position_at(near.s)
    return replace(actor, places=(replace(start, x=x, y=y), *actor.places[1:]))


def _snap_note(off: OffLanePlace) -> str:
    place = off.actor.places[off.place]
    return (
        f"ego {off.actor.id!r}: waypoint {off.place} at ({place.x:.2f}, {place.y:.2f}) lies "
        f"{off.distance:.1f} m from the nearest lane and was snapped to it"
    )
