"""Validation of a document or a scenario against its road network and the catalogues.

A valid document must not fail later for a reason that is visible in it.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

from drivora_service.errors import InvalidDocument, Problem
from drivora_service.networks.catalogue import NetworkLookup
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.scenario.checks.bend_notes import bend_notes
from drivora_service.scenario.checks.drafts import Doubts, make_whole
from drivora_service.scenario.checks.figure_notes import figure_notes
from drivora_service.scenario.checks.route_checks import RouteCheck, check_route
from drivora_service.scenario.checks.route_notes import route_notes, snap_notes
from drivora_service.scenario.checks.scenario_checks import check, snap_start
from drivora_service.scenario.checks.speed_notes import speed_notes
from drivora_service.scenario.checks.time_notes import time_notes
from drivora_service.scenario.checks.value_bounds import is_within_bounds
from drivora_service.scenario.conversion import DEFAULT_AGENT, to_scenario
from drivora_service.scenario.document_problems import (
    find_duplicate_ids,
    find_repeated_ids,
    in_document_order,
)
from drivora_service.scenario.documents import ScenarioDocument, read_document
from drivora_service.scenario.exporting import document_content
from drivora_service.scenario.model import Scenario


@dataclass(frozen=True, slots=True, kw_only=True)
class ValidScenario:
    """A valid scenario.

    Attributes:
        network: Its road network.
        notes: Interpretations to report: snapped points, default agents, figures far from what
            their place allows, which begin with a JSON pointer.
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

    Well-formed parts are checked against the road network even if other parts are malformed. What
    depends on a malformed part is not checked: the route of an actor with a mistake in it, the
    starts of others against a malformed actor, places if the frame is unknown.

    Args:
        data: Text, or data from a JSON parser.
        networks: Catalogue with the towns.
        agents: Names of the existing agents; in a mapping, with the reason why one cannot be used,
            or ""; in an ``AgentDirectory``, with their parameters; ``None``: any name is accepted.
        format: Language of the text; YAML without aliases and tags.
        driven_by: Agent that will drive every ego instead of the documented one, with the
            parameters of the egos that name it: others need not exist. "": no replacement.

    Raises:
        InvalidDocument: With every problem, in document order. Where the town is unknown, what
            depends on the road network is not checked.
        NetworkError: The town's network file cannot be read.
    """
    read = read_document(data, format)
    if read.document is not None and not read.malformed:
        return _validate(read.document, read.duplicates, read.content, networks, agents, driven_by)
    draft = make_whole(read.content, read.malformed)
    problems = read.malformed
    if draft is not None:
        checked = check(draft.document, networks, agents, driven_by, draft.doubts)
        problems = (*draft.problems, *checked.problems)
    raise InvalidDocument(in_document_order((*problems, *read.duplicates), read.content))


def validate_document(
    document: ScenarioDocument, networks: NetworkLookup, agents: Collection[str] | None
) -> ValidScenario:
    """Checks a document and converts it.

    Args:
        document: Result of ``parse_document``.
        networks: Catalogue with the towns.
        agents: As for :func:`validate_data`.

    Raises:
        InvalidDocument: With every problem, in document order. Where the town is unknown, what
            depends on the road network is not checked.
        NetworkError: The town's network file cannot be read.
    """
    content = document.model_dump()
    return _validate(document, find_duplicate_ids(content), content, networks, agents, "")


def scenario_problems(
    scenario: Scenario,
    networks: NetworkLookup,
    agents: Collection[str] | None,
    routes: RouteCheck = check_route,
) -> tuple[Problem, ...]:
    """Returns the problems of a scenario; empty if it can be run.

    These are the problems of the document of the scenario (:func:`exporting.to_document`), with
    the same pointers, codes and messages in the same order.

    Args:
        scenario: Scenario, valid or not.
        networks: Catalogue with its town.
        agents: As for :func:`validate_data`.
        routes: Checks the route of an actor. A caller with scenarios that share actors may pass a
            cached version.

    Raises:
        NetworkError: The town's network file cannot be read.
    """
    if not is_within_bounds(scenario):
        try:
            validate_data(document_content(scenario), networks, agents)
        except InvalidDocument as error:
            return error.problems
        return ()
    checked = check(scenario, networks, agents, "", Doubts(), routes)
    ids = [(f"{actor.pointer}/id", actor.id) for actor in checked.actors]
    ids += [(f"/friction_patches/{n}/id", p.id) for n, p in enumerate(scenario.friction_patches)]
    duplicates = find_repeated_ids(ids)
    problems = (*duplicates, *checked.problems)
    return in_document_order(problems, document_content(scenario)) if problems else ()


def _validate(
    document: ScenarioDocument,
    duplicates: Sequence[Problem],
    content: Mapping[str, Any],
    networks: NetworkLookup,
    agents: Collection[str] | None,
    driven_by: str,
) -> ValidScenario:
    checked = check(document, networks, agents, driven_by, Doubts())
    problems, network = (*duplicates, *checked.problems), checked.network
    if problems or network is None:
        raise InvalidDocument(in_document_order(problems, content))
    scenario = to_scenario(document, network)
    egos = tuple(
        replace(ego, route=snap_start(actor, checked.snapped, network).places)
        for ego, actor in zip(scenario.ego_vehicles, checked.actors, strict=False)
    )
    scenario = replace(scenario, ego_vehicles=egos)
    notes = [
        *(() if driven_by else _agent_notes(document)),
        *snap_notes(checked.snapped, scenario, network),
        *route_notes(scenario, network),
        *bend_notes(scenario, network),
        *speed_notes(scenario, network, with_agents=not driven_by),
        *time_notes(document, scenario, network),
        *figure_notes(document, scenario, network),
    ]
    return ValidScenario(scenario=scenario, network=network, notes=tuple(notes))


def _agent_notes(document: ScenarioDocument) -> list[str]:
    return [
        f"ego {ego.id!r} names no agent; {DEFAULT_AGENT!r} drives it"
        for ego in document.ego_vehicles
        if ego.agent_name is None
    ]
