"""Reading a campaign: the document and all its names, validated together."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from dataclasses import fields as dataclass_fields
from typing import Any, Literal, TypeVar

from pydantic import BaseModel, ValidationError

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.agents.configuration import AgentConfiguration
from drivora_service.campaigns.document.campaign import Campaign
from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.document.campaign_documents import (
    MAX_SEEDS,
    BudgetDocument,
    CampaignDocument,
    SpaceDocument,
    TesterDocument,
    to_campaign,
)
from drivora_service.campaigns.document.campaign_notes import (
    agent_notes,
    note_in_campaign,
    range_notes,
)
from drivora_service.campaigns.document.feedback_choosing import (
    FeedbackReading,
    feedback_notes,
    read_feedback,
    versions_of_objectives,
)
from drivora_service.campaigns.document.feedback_documents import FeedbackDocument
from drivora_service.campaigns.document.start_checks import check_start, start_notes
from drivora_service.errors import (
    InvalidDocument,
    OracleError,
    Problem,
    SearchError,
    UnknownName,
)
from drivora_service.given_names import stored_context
from drivora_service.known_names import unknown_name_message
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.oracles.catalogue import OracleCatalogue
from drivora_service.oracles.non_optimal_decision import NonOptimalDecision
from drivora_service.parameters import parameter_problems
from drivora_service.scenario.document_problems import in_document_order, structural_problems
from drivora_service.scenario.entities import AgentDocument
from drivora_service.scenario.model import Scenario
from drivora_service.scenario.plain_data import MAX_LOOKED_AT, plain_data
from drivora_service.scenario.validation import ValidScenario, validate_data
from drivora_service.search.budget_bounds import problems_of_tester
from drivora_service.search.candidate_space import OwnSpace
from drivora_service.search.catalogue import (
    TesterCatalogue,
    mutation_plugins,
    selection_plugins,
)
from drivora_service.search.plugin import TesterPlugin
from drivora_service.search.space.own_space import space_plugins
from drivora_service.search.space.presets import PRESETS

M = TypeVar("M", bound=BaseModel)

_PATH_ORACLE = NonOptimalDecision().name
"""The oracle that judges only egos with a reference path."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SeedScenario:
    """A scenario from which a campaign searches.

    Attributes:
        name: Its name in the document; "" of a single one.
        scenario: The scenario, driven by the campaign's agent.
        network: Its road network.
    """

    name: str
    scenario: Scenario
    network: RoadNetwork


@dataclass(frozen=True, slots=True, kw_only=True)
class ValidCampaign:
    """A campaign that can be run.

    Attributes:
        document: The document, with defaults filled in.
        seeds: The seed scenarios, at least one.
        notes: Notes on how the document was interpreted.
        versions: Versions of the packages and ADSs from outside Drivora that it names, by name.
        configuration: The ADSs of all egos with their parameters.
    """

    document: CampaignDocument
    campaign: Campaign
    seeds: tuple[SeedScenario, ...]
    notes: tuple[str, ...]
    versions: Mapping[str, str]
    configuration: AgentConfiguration

    @property
    def agent(self) -> str:
        """The names of the agents of all egos, for lists."""
        egos = [ego for seed in self.seeds for ego in seed.scenario.ego_vehicles]
        return _join_names(sorted({ego.agent.name for ego in egos}), "agents")

    @property
    def town(self) -> str:
        """The names of the road networks, for lists."""
        return _join_names([network.name for network in self._networks], "road networks")

    @property
    def network_sha256(self) -> str:
        """The hash of the road networks; see :func:`hash_of_networks`."""
        return hash_of_networks(self._networks)

    @property
    def _networks(self) -> tuple[RoadNetwork, ...]:
        return _networks_of(self.seeds)

    def notes_for(self, workers: int | None) -> tuple[str, ...]:
        """Returns the notes, and one more if the search cannot keep all workers busy.

        Args:
            workers: Number of workers; ``None``: not known.
        """
        most = self.campaign.lookahead
        if workers is None or workers <= most:
            return self.notes
        return (
            *self.notes,
            f"a lookahead of {most} keeps at most {most} of {workers} workers busy; a greater "
            "lookahead keeps more busy, and changes the search",
        )


def hash_of_networks(networks: Collection[RoadNetwork]) -> str:
    """Returns the hash of a road network; of several, that of their names and hashes."""
    if len(networks) == 1:
        (network,) = networks
        return network.sha256
    lines = sorted(f"{network.name} {network.sha256}\n" for network in networks)
    return hashlib.sha256("".join(lines).encode()).hexdigest()


def _networks_of(seeds: Sequence[SeedScenario | ValidScenario]) -> tuple[RoadNetwork, ...]:
    """Returns the road networks of seed scenarios, each once."""
    return tuple({seed.network.name: seed.network for seed in seeds}.values())


_LONGEST_LIST = 100
"""Characters of a column for lists."""


def _join_names(names: Sequence[str], what: str) -> str:
    text = ", ".join(names)
    return text if len(text) <= _LONGEST_LIST else f"{len(names)} {what}"


def read_campaign(
    data: str | bytes | Mapping[str, Any],
    catalogues: Catalogues,
    format: Literal["json", "yaml"] = "json",  # noqa: A002  # reads best in calls
    *,
    is_stored: bool = False,
) -> ValidCampaign:
    """Reads a campaign and validates it with all its names.

    Args:
        data: Text, or its parsed content.
        catalogues: Catalogues for the names.
        format: Language of the text; YAML without aliases and tags.
        is_stored: Whether it was accepted before, maybe by a version that accepted other names, and
            did not compare the parameters of testers with the budget.

    Raises:
        InvalidDocument: The document has problems; all are listed, in document order.
        NetworkError: The network's file cannot be read.
    """
    content, odd = plain_data(data, format, what="a campaign")
    document, structural = _structure(content, is_stored=is_stored)
    tester = document.tester if document else _part(TesterDocument, content, "tester")
    agent = document.agent if document else _part(AgentDocument, content, "agent")
    found, inside = _scenarios(content, catalogues, "" if agent is None else agent.name)
    # An odd value is of a wrong type as well, which is not reported again.
    known = {problem.pointer for problem in odd}
    problems = [
        *dict.fromkeys((*odd, *inside)),
        *(problem for problem in structural if problem.pointer not in known),
    ]
    if tester is not None:
        budget = None if is_stored else budget_of_seed(content)
        problems += check_tester(tester, catalogues.testers, budget)
        problems += _check_laws(tester, catalogues)
    if agent is not None:
        problems += check_agent(agent, catalogues.agents)
    space = document.space if document else _part(SpaceDocument, content, "space")
    if space is not None and space.name is not None:
        problems += check_space(space.name, space.parameters or {})
    feedback = document.feedback if document else _part(FeedbackDocument, content, "feedback")
    objectives = FeedbackReading()
    if feedback is not None:
        plugin = None if tester is None else _find_plugin(tester.name, catalogues.testers)
        objectives = read_feedback(feedback, plugin, catalogues)
        problems += objectives.problems
    if document is not None and not inside:
        problems += check_start(document, hash_of_networks(_networks_of(found)))
    names = content.get("oracles")
    if isinstance(names, list | tuple):
        wrong = {problem.pointer for problem in problems}
        problems += check_oracles(names, catalogues.oracles, wrong)
    if problems or document is None:
        raise InvalidDocument(in_document_order(problems, content))
    campaign = replace(to_campaign(document), objectives=objectives.objectives)
    seeds = tuple(
        SeedScenario(
            name=name, scenario=_replace_agent(campaign, one.scenario), network=one.network
        )
        for name, one in zip(document.seeds, found, strict=True)
    )
    return ValidCampaign(
        document=document,
        campaign=campaign,
        seeds=seeds,
        notes=(
            *_space_notes(document.space),
            *range_notes(document.space, [(seed.scenario, seed.network) for seed in seeds]),
            *agent_notes(campaign.agent, [(seed.scenario, seed.network) for seed in seeds]),
            *(
                note_in_campaign(note, number if seed.name else None, seed.name)
                for number, (seed, one) in enumerate(zip(seeds, found, strict=True))
                for note in one.notes
            ),
            *_oracle_notes(campaign, seeds, catalogues.testers),
            *start_notes(document),
            *feedback_notes(campaign.objectives, catalogues.testers.plugin(campaign.tester.name)),
        ),
        versions=_versions(campaign, [seed.scenario for seed in seeds], catalogues),
        configuration=catalogues.agents.configuration(
            ego.agent for seed in seeds for ego in seed.scenario.ego_vehicles
        ),
    )


def _space_notes(space: SpaceDocument) -> Iterator[str]:
    """Yields how a preset of the space was interpreted."""
    if space.preset is None:
        return
    preset = PRESETS[space.preset]
    changed = [
        one.name
        for one in dataclass_fields(preset.options)
        if getattr(space, one.name) != getattr(preset.options, one.name)
    ]
    note = f"the space is the preset {space.preset.value!r}: {preset.description}"
    yield f"{note}; changed in the file: {', '.join(changed)}" if changed else note


def _oracle_notes(
    campaign: Campaign, seeds: Sequence[SeedScenario], testers: TesterCatalogue
) -> Iterator[str]:
    """Yields notes on oracles that the tester needs, or that have nothing to judge."""
    tester = testers.plugin(campaign.tester.name)
    oracles = campaign.definition.oracles
    if tester.oracle and oracles is not None and tester.oracle not in oracles:
        yield (
            f"tester {tester.name!r} searches violations of the oracle {tester.oracle!r}, which do "
            "not count here: name it in `oracles`"
        )
    egos = (ego for seed in seeds for ego in seed.scenario.ego_vehicles)
    if (
        _PATH_ORACLE in (oracles or ())
        and not tester.compares_paths
        and not any(ego.reference_path for ego in egos)
    ):
        yield (
            f"the oracle {_PATH_ORACLE!r} judges nothing here: no ego has a `reference_path`, and "
            f"tester {tester.name!r} gives them none"
        )


def _versions(
    campaign: Campaign, seeds: Sequence[Scenario], catalogues: Catalogues
) -> dict[str, str]:
    tester = campaign.tester
    found = {
        **catalogues.testers.versions(tester.name),
        **mutation_plugins().versions(tester.mutation),
        **selection_plugins().versions(tester.selection),
        **catalogues.feedbacks.versions(catalogues.testers.plugin(tester.name).feedback.name),
        **versions_of_objectives(campaign.objectives, catalogues),
    }
    if isinstance(campaign.space, OwnSpace):
        found |= space_plugins().versions(campaign.space.plugin)
    # Where none is named, any may count.
    oracles = list(campaign.definition.oracles or catalogues.oracles.names())
    if _searches_laws(tester.name, catalogues):
        oracles += catalogues.oracles.library.names()
    for oracle in oracles:
        found |= catalogues.oracles.versions(oracle)
    for name in sorted({ego.agent.name for seed in seeds for ego in seed.ego_vehicles}):
        found |= catalogues.agents.versions(name)
    return found


def _structure(
    content: Mapping[str, Any], *, is_stored: bool
) -> tuple[CampaignDocument | None, list[Problem]]:
    """Returns the document, or ``None``, and the problems of its structure."""
    try:
        context = stored_context(is_stored=is_stored)
        return CampaignDocument.model_validate(content, context=context), []
    except ValidationError as error:
        problems = structural_problems(error, CampaignDocument, content)
    # The checks of the scenarios find these, and more.
    checked = tuple(f"{pointer}/" for pointer, _ in _scenario_parts(content))
    return None, [p for p in problems if not p.pointer.startswith(checked)]


def _scenario_parts(content: Mapping[str, Any]) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Yields the pointers and contents of the seed scenarios that are objects."""
    if isinstance(scenario := content.get("scenario"), Mapping):
        yield "/scenario", scenario
    several = content.get("scenarios")
    if isinstance(several, Sequence) and not isinstance(several, str):
        for place, one in enumerate(several[:MAX_SEEDS]):
            if isinstance(one, Mapping) and isinstance(scenario := one.get("scenario"), Mapping):
                yield f"/scenarios/{place}/scenario", scenario


def _scenarios(
    content: Mapping[str, Any], catalogues: Catalogues, driven_by: str
) -> tuple[list[ValidScenario], list[Problem]]:
    """Returns the valid seed scenarios, and the problems of the others.

    Args:
        content: The campaign.
        catalogues: Catalogues for the names.
        driven_by: The campaign's own agent, "" if it has none.
    """
    found: list[ValidScenario] = []
    problems: list[Problem] = []
    for pointer, scenario in _scenario_parts(content):
        valid, inside = check_scenario(pointer, scenario, catalogues, driven_by)
        found += [] if valid is None else [valid]
        problems += inside
    return found, problems


def check_scenario(
    pointer: str, scenario: Mapping[str, Any], catalogues: Catalogues, driven_by: str
) -> tuple[ValidScenario | None, list[Problem]]:
    """Returns the scenario, or ``None``, and its problems."""
    for key in ("file", "folder"):
        if key in scenario:
            message = (
                f"found a {key}; only the command line reads files: put the scenario itself here"
            )
            problem = Problem(pointer=f"{pointer}/{key}", code="scenario_file", message=message)
            return None, [problem]
    try:
        agents = catalogues.agents.availability()
        return validate_data(scenario, catalogues.networks, agents, driven_by=driven_by), []
    except InvalidDocument as error:
        return None, [
            replace(problem, pointer=f"{pointer}{problem.pointer}") for problem in error.problems
        ]


def _part(model: type[M], content: Mapping[str, Any], key: str) -> M | None:
    """Returns a valid part of a document that may be invalid elsewhere, else ``None``."""
    try:
        return model.model_validate(content.get(key))
    except ValidationError:
        return None


def check_tester(
    tester: TesterDocument, catalogue: TesterCatalogue, budget: int | None = None
) -> Iterator[Problem]:
    """Yields what is wrong with the tester of a campaign, at its places in the campaign.

    Args:
        tester: The tester.
        catalogue: Testers by name.
        budget: Simulations of each seed scenario; ``None``: parameters are not compared with it.
    """
    try:
        plugin = catalogue.plugin(tester.name)
    except UnknownName as error:
        yield _unknown("/tester/name", error, "`drivora testers list`")
    except SearchError as error:
        yield Problem(pointer="/tester/name", code="plugin", message=str(error))
    else:
        for problem in problems_of_tester(plugin, tester.parameters, budget):
            yield replace(problem, pointer=f"/tester/parameters{problem.pointer}")
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


def budget_of_seed(content: Mapping[str, Any]) -> int | None:
    """Returns the simulations of each seed scenario; ``None`` if the budget is not valid."""
    budget = _part(BudgetDocument, content, "budget")
    # Those of a study are scenarios of its campaigns, each of which has the whole budget.
    several = content.get("scenarios") if "tester" in content else None
    seeds = len(several) if isinstance(several, list | tuple) else 1
    return None if budget is None else math.ceil(budget.simulations / max(seeds, 1))


def _find_plugin(name: str, testers: TesterCatalogue) -> TesterPlugin[Any] | None:
    """Returns a tester's plug-in; ``None`` if there is none that can be used."""
    try:
        return testers.plugin(name)
    except (SearchError, UnknownName):
        return None


def _searches_laws(name: str, catalogues: Catalogues) -> bool:
    """Returns whether the results of a tester depend on the traffic laws of the installation."""
    plugin = _find_plugin(name, catalogues.testers)
    return plugin is not None and plugin.feedback.name == "lawbreaker"


def _check_laws(tester: TesterDocument, catalogues: Catalogues) -> Iterator[Problem]:
    """Checks the names of laws in the parameters of a tester that searches for violations."""
    names = tester.parameters.get("laws", ())
    if not isinstance(names, list | tuple) or not _searches_laws(tester.name, catalogues):
        return
    known = catalogues.oracles.library.names()
    for place, name in enumerate(names[:MAX_LOOKED_AT]):
        if isinstance(name, str) and name not in known:
            pointer = f"/tester/parameters/laws/{place}"
            yield _unknown(pointer, UnknownName("law", name, known), "`drivora laws list`")


def check_space(name: str, parameters: Mapping[str, Any]) -> Iterator[Problem]:
    """Checks the name and the parameters of a package's space."""
    try:
        plugin = space_plugins().plugin(name)
    except UnknownName as error:
        yield _unknown("/space/name", error, "")
    except SearchError as error:
        yield Problem(pointer="/space/name", code="plugin", message=str(error))
    else:
        for problem in parameter_problems(plugin.parameters, parameters, of=f"space {name!r}"):
            yield replace(problem, pointer=f"/space/parameters{problem.pointer}")


def check_agent(agent: AgentDocument, catalogue: AgentCatalogue) -> Iterator[Problem]:
    """Yields what is wrong with the agent of a campaign, at its places in the campaign."""
    try:
        entry = catalogue.entry(agent.name)
    except UnknownName as error:
        yield _unknown("/agent/name", error, "`drivora agents list`")
        return
    if not entry.installed:
        message = f"agent {agent.name!r} cannot be run here: {entry.reason}"
        yield Problem(pointer="/agent/name", code="agent_not_installed", message=message)
        return
    for problem in catalogue.parameter_problems(agent.name, agent.parameters):
        yield replace(problem, pointer=f"/agent/parameters{problem.pointer}")


def check_oracles(
    names: Sequence[object], catalogue: OracleCatalogue, wrong: Collection[str]
) -> Iterator[Problem]:
    """Checks the names of oracles, without those that are known to be wrong."""
    for place, name in enumerate(names[:MAX_LOOKED_AT]):
        pointer = f"/oracles/{place}"
        if pointer in wrong or not isinstance(name, str):
            continue
        try:
            catalogue.oracle(name)
        except UnknownName as error:
            yield _unknown(pointer, error, "")
        except OracleError as error:
            yield Problem(pointer=pointer, code="plugin", message=str(error))


def _unknown(pointer: str, error: UnknownName, listed_by: str) -> Problem:
    see = f". See {listed_by}" if listed_by else ""
    return Problem(
        pointer=pointer,
        code=f"unknown_{error.kind}",
        message=unknown_name_message(error.kind, error.name, error.known) + see,
    )


def _replace_agent(campaign: Campaign, seed: Scenario) -> Scenario:
    if campaign.agent is None:
        return seed
    egos = tuple(replace(ego, agent=campaign.agent) for ego in seed.ego_vehicles)
    return replace(seed, ego_vehicles=egos)
