"""Reading a campaign: the document, and all that it names, checked at once."""

from __future__ import annotations

import difflib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, TypeVar

from pydantic import BaseModel, ValidationError

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.campaigns.campaign import Campaign
from drivora_service.campaigns.documents import CampaignDocument, TesterDocument, to_campaign
from drivora_service.errors import InvalidDocument, Problem, SearchError, UnknownName
from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.parameters import read_parameters
from drivora_service.scenario.documents import ScenarioDocument
from drivora_service.scenario.entities import AgentDocument
from drivora_service.scenario.model import Scenario
from drivora_service.scenario.plain_data import plain_data
from drivora_service.scenario.problems import (
    duplicate_ids,
    in_document_order,
    structural_problems,
)
from drivora_service.scenario.validation import ValidScenario, validate_document
from drivora_service.search.catalogue import (
    TesterCatalogue,
    mutation_plugins,
    selection_plugins,
)

M = TypeVar("M", bound=BaseModel)


@dataclass(frozen=True, slots=True, kw_only=True)
class Catalogues:
    """Where the names in a campaign are looked up."""

    networks: NetworkCatalogue
    agents: AgentCatalogue
    testers: TesterCatalogue


@dataclass(frozen=True, slots=True, kw_only=True)
class ValidCampaign:
    """A campaign that can be run.

    Attributes:
        document: As it was written, defaults filled in.
        seed: The scenario to begin with, driven by the campaign's agent.
        network: The road network that it takes place on.
        notes: What was interpreted on the way, for people.
    """

    document: CampaignDocument
    campaign: Campaign
    seed: Scenario
    network: RoadNetwork
    notes: tuple[str, ...]


def read_campaign(
    data: str | bytes | Mapping[str, Any],
    catalogues: Catalogues,
    format: Literal["json", "yaml"] = "json",  # noqa: A002  # reads best in calls
) -> ValidCampaign:
    """Reads a campaign and checks it, and all that it names.

    Args:
        data: Text, or what a parser made of it.
        catalogues: What there is.
        format: Language of the text; YAML without aliases and tags.

    Raises:
        InvalidDocument: With every problem, in document order.
        NetworkError: The network's file cannot be read.
    """
    content, problems = plain_data(data, format, what="a campaign")
    document, structural = _structure(content, problems)
    problems += structural
    tester = document.tester if document else _part(TesterDocument, content, "tester")
    if tester is not None:
        problems += _check_tester(tester, catalogues.testers)
    agent = document.agent if document else _part(AgentDocument, content, "agent")
    if agent is not None:
        problems += _check_agent(agent, catalogues.agents)
    scenario = document.scenario if document else _part(ScenarioDocument, content, "scenario")
    valid: ValidScenario | None = None
    if scenario is not None:
        try:
            valid = validate_document(scenario, catalogues.networks, catalogues.agents.names())
        except InvalidDocument as error:
            problems += _inside("/scenario", error.problems)
    if problems or document is None or valid is None:
        raise InvalidDocument(in_document_order(problems, content))
    campaign = to_campaign(document)
    return ValidCampaign(
        document=document,
        campaign=campaign,
        seed=_driven_by(campaign, valid.scenario),
        network=valid.network,
        notes=valid.notes,
    )


def _structure(
    content: dict[str, Any], odd: Sequence[Problem]
) -> tuple[CampaignDocument | None, list[Problem]]:
    """Gives the document if it is one, and what is wrong with its structure."""
    known = {problem.pointer for problem in odd}
    scenario = content.get("scenario")
    problems = []
    if isinstance(scenario, Mapping):
        problems += _inside("/scenario", duplicate_ids(scenario))
        if "file" in scenario:
            message = (
                "found a file name; only the command line reads files: put the scenario itself here"
            )
            problems.append(
                Problem(pointer="/scenario/file", code="scenario_file", message=message)
            )
    try:
        return CampaignDocument.model_validate(content), problems
    except ValidationError as error:
        found = structural_problems(error, CampaignDocument)
    if any(problem.code == "scenario_file" for problem in problems):
        # What else is wrong there only follows from it.
        found = [problem for problem in found if not problem.pointer.startswith("/scenario")]
    return None, [*problems, *(problem for problem in found if problem.pointer not in known)]


def _part(model: type[M], content: Mapping[str, Any], key: str) -> M | None:
    """Gives a part of a document whose other parts are wrong; ``None`` where it is wrong itself."""
    try:
        return model.model_validate(content.get(key))
    except ValidationError:
        return None


def _check_tester(tester: TesterDocument, catalogue: TesterCatalogue) -> Iterator[Problem]:
    try:
        plugin = catalogue.plugin(tester.name)
    except UnknownName as error:
        yield _unknown("/tester/name", error, "`drivora testers list`")
    except SearchError as error:
        yield Problem(pointer="/tester/name", code="plugin", message=str(error))
    else:
        try:
            read_parameters(plugin.parameters, tester.parameters, of=f"tester {tester.name!r}")
        except SearchError as error:
            yield Problem(
                pointer="/tester/parameters", code="tester_parameters", message=str(error)
            )
    for kind, name, table in (
        ("mutation", tester.mutation, mutation_plugins()),
        ("selection", tester.selection, selection_plugins()),
    ):
        if name is None:
            continue
        try:
            table.plugin(name)
        except UnknownName as error:
            yield _unknown(f"/tester/{kind}", error, "")
        except SearchError as error:
            yield Problem(pointer=f"/tester/{kind}", code="plugin", message=str(error))


def _check_agent(agent: AgentDocument, catalogue: AgentCatalogue) -> Iterator[Problem]:
    try:
        entry = catalogue.entry(agent.name)
    except UnknownName as error:
        yield _unknown("/agent/name", error, "`drivora agents list`")
        return
    if not entry.installed:
        message = f"agent {agent.name!r} cannot be run here: {entry.reason}"
        yield Problem(pointer="/agent/name", code="agent_not_installed", message=message)


def _unknown(pointer: str, error: UnknownName, listed_by: str) -> Problem:
    close = difflib.get_close_matches(error.name, error.known, n=1)
    guess = f"; did you mean {close[0]!r}?" if close else ""
    known = ", ".join(error.known) or "none"
    see = f" See {listed_by}" if listed_by else ""
    return Problem(
        pointer=pointer,
        code=f"unknown_{error.kind}",
        message=f"found {error.kind} {error.name!r}, which there is not{guess} Known: {known}."
        f"{see}".replace("not Known", "not; known"),
    )


def _inside(pointer: str, problems: Sequence[Problem]) -> list[Problem]:
    return [replace(problem, pointer=pointer + problem.pointer) for problem in problems]


def _driven_by(campaign: Campaign, seed: Scenario) -> Scenario:
    if campaign.agent is None:
        return seed
    egos = tuple(replace(ego, agent=campaign.agent) for ego in seed.ego_vehicles)
    return replace(seed, ego_vehicles=egos)
