"""Everything that an editor shows of a document while it is written, valid or not."""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import shapely

from drivora_service.errors import NoRoute, Problem
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.networks.catalogue import NetworkLookup
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.networks.routes.routing import plan_route
from drivora_service.scenario.checks.drafts import Doubts, make_whole
from drivora_service.scenario.checks.placed_actors import PlacedActor
from drivora_service.scenario.checks.route_checks import JOIN_DISTANCE, check_route, route_points
from drivora_service.scenario.checks.scenario_checks import Checked, check, snap_start
from drivora_service.scenario.document_problems import in_document_order
from drivora_service.scenario.documents import read_document
from drivora_service.scenario.model import NpcBehavior, Waypoint
from drivora_service.scenario.models.actor_models import ActorKind, ActorModel
from drivora_service.scenario.validation import validate_data

_SEEN = 0.02
"""Metres by which a way on a map may be beside the planned one."""


@dataclass(frozen=True, slots=True, kw_only=True)
class InspectedActor:
    """An actor as it appears, and the way that it will take.

    Attributes:
        pointer: JSON pointer to it.
        kind: Kind of its model.
        x: Of its box centre at its start, metres in the network's plane.
        y: The same.
        yaw: Heading at its start, radians counter-clockwise from east.
        length: Metres.
        width: Metres.
        path: (n, 2) the way along the lanes, or from waypoint to waypoint where it does not follow
            lanes, metres in the network's plane; (0, 2): it stays, or there is no way.
    """

    pointer: str
    id: str
    kind: ActorKind
    x: float
    y: float
    yaw: float
    length: float
    width: float
    path: FloatArray

    @property
    def path_length(self) -> float:
        """Length of the way, metres."""
        return float(np.hypot(*np.diff(self.path, axis=0).T).sum()) if len(self.path) else 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Inspection:
    """What is known of a document.

    Attributes:
        problems: Everything that is wrong with it, in document order; empty if it can be run.
        notes: Interpretations of a valid document.
        town: Name of its road network; "" if that is unknown.
        actors: The actors that are well-formed and have a known model.
    """

    problems: tuple[Problem, ...]
    notes: tuple[str, ...]
    town: str
    actors: tuple[InspectedActor, ...]


def inspect_data(
    data: str | bytes | Mapping[str, Any],
    networks: NetworkLookup,
    agents: Collection[str] | None,
    format: Literal["json", "yaml"] = "json",  # noqa: A002  # as in validate_data
) -> Inspection:
    """Checks a document as :func:`~drivora_service.scenario.validation.validate_data` does.

    The actors of a document with problems are found as well, as far as they are well-formed.

    Args:
        data: Text, or data from a JSON parser.
        networks: Catalogue with the towns.
        agents: Agents that exist, as for ``validate_data``.
        format: Language of the text; YAML without aliases and tags.

    Raises:
        InvalidDocument: The text cannot be read at all.
        NetworkError: The town's network file cannot be read.
    """
    read = read_document(data, format)
    problems = (*read.malformed, *read.duplicates)
    checked: Checked | None = None
    doubts = Doubts()
    if read.document is not None and not read.malformed:
        checked = check(read.document, networks, agents, "", doubts)
    elif draft := make_whole(read.content, read.malformed):
        problems, doubts = (*draft.problems, *read.duplicates), draft.doubts
        checked = check(draft.document, networks, agents, "", doubts)
    if checked is not None:
        problems = (*problems, *checked.problems)
    town = checked.network.name if checked is not None and checked.network is not None else ""
    return Inspection(
        problems=in_document_order(problems, read.content),
        notes=() if problems else validate_data(read.content, networks, agents).notes,
        town=town,
        actors=() if checked is None else _inspect_actors(checked, doubts),
    )


def _inspect_actors(checked: Checked, doubts: Doubts) -> tuple[InspectedActor, ...]:
    network = checked.network
    if network is None or doubts.cover("/frame"):
        return ()
    lost = {problem.pointer for problem in checked.problems if problem.code == "off_network"}
    found = []
    for actor in checked.actors:
        places = [actor.place_pointer(place) for place in range(len(actor.places))]
        parts = (actor.pointer, f"{actor.pointer}/model", *places)
        if actor.model is None or any(doubts.cover(part) for part in parts):
            continue
        is_lost = any(place in lost for place in places)
        start = snap_start(actor, checked.snapped, network)
        found.append(_actor(start, actor.model, network, is_lost=is_lost))
    return tuple(found)


def _actor(
    actor: PlacedActor, model: ActorModel, network: RoadNetwork, *, is_lost: bool
) -> InspectedActor:
    start = actor.places[0]
    pose = None if is_lost else check_route(actor, network)[1]
    x, y, yaw = start.x, start.y, start.yaw or 0.0
    if pose is not None:
        x, y, yaw = pose.x, pose.y, pose.yaw
    return InspectedActor(
        pointer=actor.pointer,
        id=actor.id,
        kind=model.kind,
        x=x,
        y=y,
        yaw=yaw,
        length=model.length,
        width=model.width,
        path=_thin(_path(actor, network)),
    )


def _thin(path: FloatArray) -> FloatArray:
    """Returns a path without the points that do not matter on a map."""
    if len(path) < 3:
        return path
    line = shapely.LineString(path).simplify(_SEEN)
    return np.array(line.coords)


def _path(actor: PlacedActor, network: RoadNetwork) -> FloatArray:
    """Returns the way of an actor, as ``scenario.checks.route_checks`` sees it."""
    places = actor.places
    if len(places) < 2:
        return np.empty((0, 2))
    if actor.is_ego or actor.behavior is NpcBehavior.SUMO:
        return _lanes(places, network)
    if actor.behavior is not NpcBehavior.REACTIVE:
        return _straight(places)
    parts = []
    for here, there in itertools.pairwise(places):
        is_near = math.hypot(here.x - there.x, here.y - there.y) <= JOIN_DISTANCE
        part = _straight((here, there)) if is_near else _lanes((here, there), network)
        if not len(part):
            break
        parts.append(part)
    return np.concatenate(parts) if parts else np.empty((0, 2))


def _lanes(places: tuple[Waypoint, ...], network: RoadNetwork) -> FloatArray:
    try:
        return plan_route(network, route_points(places)).line
    except NoRoute:
        return np.empty((0, 2))


def _straight(places: tuple[Waypoint, ...]) -> FloatArray:
    return np.array([(place.x, place.y) for place in places])
