"""The subjects of a comparison: which campaigns are repetitions, and which may be compared."""

from __future__ import annotations

import hashlib
import json
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from drivora_service.campaigns.document.campaign import FeedbackMode
from drivora_service.campaigns.document.campaign_documents import CampaignDocument, TesterDocument
from drivora_service.errors import CampaignError, SearchError, UnknownName
from drivora_service.given_names import read_stored
from drivora_service.parameters import read_parameters
from drivora_service.scenario.documents import ScenarioDocument
from drivora_service.store.campaigns.campaign_records import CampaignRecord, CampaignState
from drivora_service.studies.campaign_figures import Subject

if TYPE_CHECKING:
    from drivora_service.search.catalogue import TesterCatalogue

_WITHOUT_FEEDBACK = " without feedback"
_DEFAULT = "default"
_SHORT = 8
"""Digits of a hash that name a scenario."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Compared:
    """A campaign in a comparison.

    Attributes:
        subject: Its names in the comparison.
    """

    record: CampaignRecord
    document: CampaignDocument
    subject: Subject


def make_compared_campaigns(
    records: Sequence[CampaignRecord], testers: TesterCatalogue
) -> tuple[Compared, ...]:
    """Names the methods and scenarios of campaigns for a comparison.

    A method is named after its tester, with "without feedback" if its results were shuffled, "from
    failures" or "from elites" if it started from those of another campaign, and with those of its
    parameters, components and lookahead in which the campaigns of this tester differ. A scenario is
    named after its town, with the beginning of a hash if there are several of one town.

    Args:
        records: The campaigns.
        testers: Catalogue with the defaults of parameters that a campaign does not give.

    Raises:
        CampaignError: One has not finished, or campaigns on the same scenario differ in conditions
            that must be equal; the message names them.
    """
    for record in records:
        _refuse_unfinished(record)
    documents = [read_stored(CampaignDocument, record.document) for record in records]
    scenarios = _scenario_names(documents)
    methods = _method_names(documents, testers)
    compared = tuple(
        Compared(
            record=record,
            document=document,
            subject=Subject(
                campaign=record.id, method=method, scenario=scenario, seed=document.seed
            ),
        )
        for record, document, scenario, method in zip(
            records, documents, scenarios, methods, strict=True
        )
    )
    first: dict[str, Compared] = {}
    for campaign in compared:
        _refuse_differences(first.setdefault(campaign.subject.scenario, campaign), campaign)
    return compared


def _refuse_unfinished(record: CampaignRecord) -> None:
    if record.state is CampaignState.FINISHED:
        return
    begun = f"after {record.counts.simulations} of {record.budget} simulations"
    hint = (
        "leave it out"
        if record.state.is_over
        else f"finish it (drivora campaign resume {record.id}) or leave it out"
    )
    raise CampaignError(
        f"campaign {record.id} ({record.name}) is {record.state} {begun}; only finished campaigns "
        f"are compared: {hint}"
    )


def _refuse_differences(first: Compared, other: Compared) -> None:
    mine, theirs = _conditions(first), _conditions(other)
    # Spaces of packages have other options than the built-in one.
    names = dict.fromkeys((*mine, *theirs))
    differing = [name for name in names if mine.get(name) != theirs.get(name)]
    if differing:
        what = "; ".join(
            f"{name}: {_text(mine.get(name))} and {_text(theirs.get(name))}" for name in differing
        )
        raise CampaignError(
            f"campaigns {first.record.id} ({first.record.name}) and {other.record.id} "
            f"({other.record.name}) differ in more than the method: {what}. Compare those that "
            "agree in this"
        )


def _conditions(campaign: Compared) -> dict[str, Any]:
    """Returns the conditions that must be equal for all campaigns on a scenario, by name."""
    document = campaign.document
    return {
        "budget": document.budget.simulations,
        "failures": str(document.definition),
        "agent": campaign.record.agent,
        "agent parameters": _agent_parameters(document),
        **{f"space.{name}": value for name, value in document.space.model_dump().items()},
        "road network": campaign.record.network_sha256[:_SHORT],
    }


def _agent_parameters(document: CampaignDocument) -> list[Mapping[str, Any]]:
    """Returns the different parameters of the egos' agents."""
    egos = [ego for scenario in document.seeds.values() for ego in scenario.ego_vehicles]
    agents = [ego.agent if document.agent is None else document.agent for ego in egos]
    different: list[Mapping[str, Any]] = []
    for agent in agents:
        parameters = {} if agent is None else agent.parameters
        if parameters not in different:
            different.append(parameters)
    return different


def _scenario_names(documents: Sequence[CampaignDocument]) -> list[str]:
    hashes = [_scenario_hash(document) for document in documents]
    towns = [_towns(document) for document in documents]
    of_town: dict[str, set[str]] = defaultdict(set)
    for town, digest in zip(towns, hashes, strict=True):
        of_town[town].add(digest)
    return [
        town if len(of_town[town]) == 1 else f"{town} ({digest[:_SHORT]})"
        for town, digest in zip(towns, hashes, strict=True)
    ]


def scenario_identity(scenario: ScenarioDocument) -> dict[str, Any]:
    """Returns what identifies a seed scenario, regardless of its agents."""
    drivers = {"agent": True, "config_path": True}
    return scenario.model_dump(mode="json", exclude={"ego_vehicles": {"__all__": drivers}})


def _scenario_hash(document: CampaignDocument) -> str:
    """Returns the identity of the seed scenarios, regardless of their agents."""
    contents = [scenario_identity(scenario) for scenario in document.seeds.values()]
    content = contents[0] if document.scenario is not None else contents
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def _towns(document: CampaignDocument) -> str:
    towns = sorted({scenario.map_region.town for scenario in document.seeds.values()})
    if document.scenario is not None:
        return towns[0]
    where = towns[0] if len(towns) == 1 else f"{len(towns)} networks"
    return f"{len(document.seeds)} scenarios of {where}"


def _method_names(documents: Sequence[CampaignDocument], testers: TesterCatalogue) -> list[str]:
    traits = [_traits(document, testers) for document in documents]
    differing: dict[str, list[str]] = {}
    for tester in {document.tester.name for document in documents}:
        own = [t for d, t in zip(documents, traits, strict=True) if d.tester.name == tester]
        names = dict.fromkeys(name for known in own for name in known)
        differing[tester] = [
            name for name in names if len({known.get(name, _DEFAULT) for known in own}) > 1
        ]
    return [
        _group_name(d, {name: own.get(name, _DEFAULT) for name in differing[d.tester.name]})
        for d, own in zip(documents, traits, strict=True)
    ]


def _group_name(document: CampaignDocument, traits: Mapping[str, str]) -> str:
    shuffled = document.tester.feedback is FeedbackMode.SHUFFLED
    told = ", ".join(f"{name} {value}" for name, value in traits.items())
    start = document.tester.start_from
    return (
        document.tester.name
        + (_WITHOUT_FEEDBACK if shuffled else "")
        + ("" if start is None else f" from {start.kind}")
        + (f" ({told})" if told else "")
    )


def _traits(document: CampaignDocument, testers: TesterCatalogue) -> dict[str, str]:
    """Returns the traits in which campaigns of one tester may differ, as text by name."""
    tester = document.tester
    return {
        **{name: _text(value) for name, value in _parameters(tester, testers).items()},
        "mutation": tester.mutation or "its own",
        "selection": tester.selection or "its own",
        "feedback": "its own" if document.feedback is None else document.feedback.words,
        "lookahead": str(document.lookahead),
    }


def _parameters(tester: TesterDocument, testers: TesterCatalogue) -> Mapping[str, Any]:
    """Returns all parameters; only the given ones if the tester is not installed."""
    try:
        plugin = testers.plugin(tester.name)
        known = read_parameters(plugin.parameters, tester.parameters, of=f"tester {tester.name!r}")
    except (SearchError, UnknownName):
        return tester.parameters
    return asdict(known)


def _text(value: object) -> str:
    return value if isinstance(value, str) else json.dumps(value, default=str)
