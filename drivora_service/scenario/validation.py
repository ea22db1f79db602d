"""Checks a document against its road network and the catalogues; gives the scenario to run.

Nothing that passes may fail later for a reason that the document shows.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

from drivora_service.errors import InvalidDocument, Problem, UnknownName
from drivora_service.networks.catalogue import NetworkLookup
from drivora_service.networks.projection import nearest_lane_position
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.scenario import fields
from drivora_service.scenario.agent_checks import check_agents
from drivora_service.scenario.conversion import (
    DEFAULT_AGENT,
    background_count,
    frame_of,
    region,
    to_scenario,
)
from drivora_service.scenario.documents import ScenarioDocument, read_document
from drivora_service.scenario.drafts import Doubts, make_whole
from drivora_service.scenario.frames import FrameTransform
from drivora_service.scenario.model import Region, Scenario
from drivora_service.scenario.place_checks import OffLanePlace, check_places
from drivora_service.scenario.placed_actors import PlacedActor, place_actors
from drivora_service.scenario.plain_data import pointer
from drivora_service.scenario.problems import duplicate_ids, in_document_order
from drivora_service.scenario.route_checks import check_route
from drivora_service.scenario.route_notes import route_notes, snap_notes
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


def validate_data(
    data: str | bytes | Mapping[str, Any],
    networks: NetworkLookup,
    agents: Collection[str] | None,
    format: Literal["json", "yaml"] = "json",  # noqa: A002  # reads best in calls
    *,
    driven_by: str = "",
) -> ValidScenario:
    """Reads a document, checks it and converts it.

    What is well-formed is checked against the road network even where other parts are not. What
    depends on a malformed part is not: the route of an actor with a mistake in it, the starts of
    others against a malformed actor, places where the frame is not known.

    Args:
        data: Text, or what a JSON parser made of it.
        networks: Where towns are looked up.
        agents: Names of the agents that exist; in a mapping, with the reason why one cannot be
            used, or ""; in an ``AgentDirectory``, with the parameters that they take; ``None``: any
            name will do.
        format: Language of the text; YAML without aliases and tags.
        driven_by: Agent that will drive every ego in place of whom the document names, with the
            parameters of the egos that name it: others need not exist. "": as documented.

    Raises:
        InvalidDocument: With every problem, in document order. Where the town is unknown, what
            depends on the road network is not checked.
        NetworkError: The town's network file cannot be read.
    """
    read = read_document(data, format)
    if read.document is not None and not read.malformed:
        return _validated(read.document, read.duplicates, read.content, networks, agents, driven_by)
    draft = make_whole(read.content, read.malformed)
    problems = read.malformed
    if draft is not None:
        checked = _check(draft.document, networks, agents, driven_by, draft.doubts)
        problems = (*draft.problems, *checked.problems)
    raise InvalidDocument(in_document_order((*problems, *read.duplicates), read.content))


def validate_document(
    document: ScenarioDocument, networks: NetworkLookup, agents: Collection[str] | None
) -> ValidScenario:
    """Checks a document and converts it.

    Args:
        document: What ``parse_document`` gave.
        networks: Where towns are looked up.
        agents: As for :func:`validate_data`.

    Raises:
        InvalidDocument: With every problem, in document order. Where the town is unknown, what
            depends on the road network is not checked.
        NetworkError: The town's network file cannot be read.
    """
    content = document.model_dump()
    return _validated(document, duplicate_ids(content), content, networks, agents, "")


@dataclass(frozen=True, slots=True, kw_only=True)
class _Checked:
    """What the checks of a document found.

    Attributes:
        network: ``None`` where the town is not known.
        snapped: Waypoints of egos beside the lanes.
    """

    problems: tuple[Problem, ...]
    network: RoadNetwork | None
    actors: tuple[PlacedActor, ...]
    snapped: tuple[OffLanePlace, ...]


def _validated(
    document: ScenarioDocument,
    duplicates: Sequence[Problem],
    content: Mapping[str, Any],
    networks: NetworkLookup,
    agents: Collection[str] | None,
    driven_by: str,
) -> ValidScenario:
    checked = _check(document, networks, agents, driven_by, Doubts())
    problems, network = (*duplicates, *checked.problems), checked.network
    if problems or network is None:
        raise InvalidDocument(in_document_order(problems, content))
    scenario = to_scenario(document, network)
    egos = tuple(
        replace(ego, route=_snap_start(actor, checked.snapped, network).places)
        for ego, actor in zip(scenario.ego_vehicles, checked.actors, strict=False)
    )
    scenario = replace(scenario, ego_vehicles=egos)
    notes = [
        *(() if driven_by else _agent_notes(document)),
        *snap_notes(checked.snapped, scenario, network),
        *route_notes(scenario, network),
    ]
    return ValidScenario(scenario=scenario, network=network, notes=tuple(notes))


def _check(
    document: ScenarioDocument,
    networks: NetworkLookup,
    agents: Collection[str] | None,
    driven_by: str,
    doubts: Doubts,
) -> _Checked:
    problems = check_agents(document, agents, driven_by)
    network: RoadNetwork | None = None
    if not doubts.cover("/map_region/town"):
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
        if not doubts.cover("/frame"):
            segment = region(document.map_region.region_segment, frame)
            place_problems, snapped = _check_on_network(actors, network, segment, doubts)
            problems += place_problems
        problems += _check_lights(document, network)
        problems += _check_background(document, network)
    return _Checked(
        problems=tuple(problem for problem in problems if not doubts.cover(problem.pointer)),
        network=network,
        actors=actors,
        snapped=tuple(snapped),
    )


def _check_on_network(
    actors: Sequence[PlacedActor], network: RoadNetwork, segment: Region | None, doubts: Doubts
) -> tuple[list[Problem], list[OffLanePlace]]:
    problems, snapped = check_places(actors, network, segment)
    lost = {problem.pointer for problem in problems if problem.code == "off_network"}
    poses: list[StartPose] = []
    for actor in actors:
        if any(actor.place_pointer(index) in lost for index in range(len(actor.places))):
            continue
        route_problems, pose = check_route(_snap_start(actor, snapped, network), network)
        problems += route_problems
        if pose is not None and not doubts.touch(actor.pointer):
            poses.append(pose)
    problems += check_overlaps(poses)
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
