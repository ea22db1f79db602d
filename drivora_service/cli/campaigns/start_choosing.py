"""The candidates that a campaign starts from: those of an earlier campaign, or of its folder."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from drivora_service.campaigns.document.campaign_documents import CampaignDocument, SpaceDocument
from drivora_service.campaigns.document.start_documents import StartKind
from drivora_service.cli.application.references import id_of
from drivora_service.errors import ConfigurationError, NotFound
from drivora_service.given_names import read_stored
from drivora_service.scenario.documents import ScenarioDocument
from drivora_service.search.tester import EvaluationStatus
from drivora_service.store.campaigns.campaign_records import (
    Confirmation,
    EvaluationFilter,
    EvaluationSummary,
)
from drivora_service.store.id_records import IdKind
from drivora_service.studies.comparison.compared_subjects import scenario_identity

if TYPE_CHECKING:
    from drivora_service.api.schemas.campaigns import Failure
    from drivora_service.client import Client

DEFAULT_MOST = 20
"""Candidates of each seed scenario that a search starts from."""

_MOST_DIFFERENCES = 5


@dataclass(frozen=True, slots=True, kw_only=True)
class StartChoice:
    """What a user chose to start from.

    Attributes:
        source: A campaign by its id, the first digits of it, its name or ``latest``, or a folder
            that one was written to.
        folder: Folder that a relative ``source`` is relative to.
        kind: Whether its failures or its elites.
        most: Candidates of each seed scenario, at most.
        is_folder: Whether the source is a folder; ``None``: if there is one of that name.
    """

    source: str
    folder: Path
    kind: StartKind = StartKind.FAILURES
    most: int = DEFAULT_MOST
    is_folder: bool | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Scene:
    """A seed scenario and its space."""

    scenario: ScenarioDocument
    space: SpaceDocument


@dataclass(frozen=True, slots=True, kw_only=True)
class _Found:
    """A candidate of an earlier campaign.

    Attributes:
        place: Place of its seed scenario in that campaign.
    """

    place: int
    values: tuple[float, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Earlier:
    """An earlier campaign, and the chosen ones of its candidates.

    Attributes:
        title: What it is called in messages.
    """

    title: str
    document: CampaignDocument
    network_sha256: str
    candidates: tuple[_Found, ...]


class _Exported(BaseModel):
    """The parts of ``campaign.json`` that are read."""

    model_config = ConfigDict(extra="ignore")

    id: str
    name: str
    document: dict[str, Any]
    network_sha256: str
    candidates: list[_ExportedCandidate] = Field(default_factory=list)


class _ExportedCandidate(BaseModel):
    evaluation: int
    seed_number: int
    values: tuple[float, ...]


def find_earlier(client: Client, choice: StartChoice) -> Earlier:
    """Returns the campaign that was chosen to start from, with the chosen candidates.

    Raises:
        ConfigurationError: There is none, or it has no such candidates.
        ServiceError: The service refused or did not answer.
    """
    path = choice.folder / choice.source
    if choice.is_folder or (choice.is_folder is None and path.is_dir()):
        return _read_folder(path, choice)
    return _read_campaign(client, choice)


def start_of(earlier: Earlier, choice: StartChoice, scenes: Mapping[str, Scene]) -> dict[str, Any]:
    """Returns the part ``start_from`` of a document.

    Args:
        earlier: The earlier campaign.
        choice: What the user chose.
        scenes: The seed scenarios of the document, by name.

    Raises:
        ConfigurationError: The earlier campaign searched other scenes.
    """
    names = _matching_scenes(earlier, scenes)
    candidates = [
        {"seed": name, "values": list(one.values)}
        for one in earlier.candidates
        for name in names.get(one.place, ())
    ]
    if not candidates:
        raise ConfigurationError(
            f"{earlier.title} has no {choice.kind} of these seed scenarios; those that it has are "
            "of its other ones"
        )
    content: dict[str, Any] = {
        "source": earlier.title,
        "kind": str(choice.kind),
        "candidates": candidates,
    }
    towns = {scene.scenario.map_region.town for scene in scenes.values()}
    own = {one.map_region.town for one in earlier.document.seeds.values()}
    if towns == own:
        # The hash of several road networks is one of all of them together.
        content["network_sha256"] = earlier.network_sha256
    return content


def _matching_scenes(earlier: Earlier, scenes: Mapping[str, Scene]) -> dict[int, list[str]]:
    """Returns the names of the seed scenarios that are those of the earlier campaign, by place."""
    names: dict[int, list[str]] = {}
    for place, scenario in enumerate(earlier.document.seeds.values()):
        identity = scenario_identity(scenario)
        for name, scene in scenes.items():
            if scenario_identity(scene.scenario) == identity:
                names.setdefault(place, []).append(name)
                _refuse_other_space(earlier, scene.space)
    if names:
        return names
    first = next(iter(scenes.values()))
    old = next(iter(earlier.document.seeds.values()))
    where = _list_differences(scenario_identity(old), scenario_identity(first.scenario))
    raise ConfigurationError(
        f"{earlier.title} searched from another seed scenario, so that its genes mean another "
        f"thing here: {where}. Start from a campaign on the same scenario, or without one"
    )


def _refuse_other_space(earlier: Earlier, space: SpaceDocument) -> None:
    # A preset is only a name for values.
    old, new = (one.model_dump(mode="json") for one in (earlier.document.space, space))
    for one in (old, new):
        one.pop("preset", None)
    if old != new:
        raise ConfigurationError(
            f"{earlier.title} searched another space, so that its genes mean another thing here: "
            f"{_list_differences(old, new, '/space')}. Give this campaign the same `space`, or "
            "start without it"
        )


def _list_differences(old: object, new: object, pointer: str = "") -> str:
    found = list(_differences(old, new, pointer))
    more = len(found) - _MOST_DIFFERENCES
    return "; ".join(found[:_MOST_DIFFERENCES]) + (f" and {more} more" if more > 0 else "")


def _differences(old: object, new: object, pointer: str) -> Iterator[str]:
    if isinstance(old, Mapping) and isinstance(new, Mapping):
        for key in (*old, *(key for key in new if key not in old)):
            yield from _differences(old.get(key), new.get(key), f"{pointer}/{key}")
    elif isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
        for place, (one, other) in enumerate(zip(old, new, strict=True)):
            yield from _differences(one, other, f"{pointer}/{place}")
    elif old != new:
        yield f"{pointer} {_short(old)} there, {_short(new)} here"


def _short(value: object) -> str:
    if isinstance(value, list):
        return f"{len(value)} entries"
    if isinstance(value, Mapping):
        return "given"
    return "not given" if value is None else json.dumps(value)


def _read_campaign(client: Client, choice: StartChoice) -> Earlier:
    try:
        campaign = client.campaign(id_of(client, choice.source, IdKind.CAMPAIGN))
    except NotFound as error:
        folder = (
            "" if choice.is_folder is False else f"\nThere is no folder {choice.source!r} either"
        )
        raise ConfigurationError(f"{error}{folder}") from error
    title = f"campaign {campaign.id} ({campaign.name})"
    summaries = (
        _choose_failures(client, campaign.id)
        if choice.kind is StartKind.FAILURES
        else _rank_elites(client.evaluations(campaign.id))
    )
    chosen = _first_of_each_seed(summaries, choice.most)
    if not chosen:
        what = (
            "found no failure that an identical run repeated"
            if choice.kind is StartKind.FAILURES
            else "has no candidate with a measured objective"
        )
        hint = "; start from its elites" if choice.kind is StartKind.FAILURES else ""
        raise ConfigurationError(f"{title} {what}: there is nothing to start from{hint}")
    return Earlier(
        title=title,
        document=read_stored(CampaignDocument, campaign.document),
        network_sha256=campaign.network_sha256,
        candidates=tuple(
            _Found(place=one.seed_number, values=client.evaluation(campaign.id, one.number).values)
            for one in chosen
        ),
    )


def _choose_failures(client: Client, campaign_id: str) -> list[EvaluationSummary]:
    """Returns the failing candidates, the first one of each kind first."""
    failing = {
        one.number: one for one in client.evaluations(campaign_id, EvaluationFilter(violating=True))
    }
    return [failing[number] for number in order_failures(client.failures(campaign_id))]


def order_failures(failures: Iterable[Failure]) -> list[int]:
    """Returns the numbers of failing evaluations, the first one of each kind first."""
    stable = [one for one in failures if one.confirmation is not Confirmation.FLAKY]
    first = {one.kind: one.evaluation for one in reversed(stable)}
    numbers = (*sorted(first.values()), *(one.evaluation for one in stable))
    return list(dict.fromkeys(numbers))


def _rank_elites(evaluations: Iterable[EvaluationSummary]) -> list[EvaluationSummary]:
    """Returns the judged candidates by the mean of their ranks in each objective, best first.

    An objective that is not measurable ranks last. Ranks are compared since objectives have units
    of their own.
    """
    judged = [
        one
        for one in evaluations
        if one.status is EvaluationStatus.JUDGED
        and any(value is not None for value in one.objectives.values())
    ]
    ranks = dict.fromkeys((one.number for one in judged), 0)
    for name in dict.fromkeys(name for one in judged for name in one.objectives):
        known = {value for one in judged if (value := one.objectives.get(name)) is not None}
        rank_of = {value: rank for rank, value in enumerate(sorted(known))}
        for one in judged:
            value = one.objectives.get(name)
            ranks[one.number] += len(known) if value is None else rank_of[value]
    return sorted(judged, key=lambda one: (ranks[one.number], one.number))


def _first_of_each_seed(
    summaries: Sequence[EvaluationSummary], most: int
) -> list[EvaluationSummary]:
    """Returns so many different scenarios of each seed scenario."""
    counts: dict[int, int] = {}
    seen: set[str] = set()
    chosen = []
    for one in summaries:
        count = counts.get(one.seed_number, 0)
        if count < most and one.scenario_sha256 not in seen:
            seen.add(one.scenario_sha256)
            counts[one.seed_number] = count + 1
            chosen.append(one)
    return chosen


def _read_folder(folder: Path, choice: StartChoice) -> Earlier:
    file = folder / "campaign.json"
    if not file.is_file():
        raise ConfigurationError(
            f"{folder} holds no campaign.json: scenarios by themselves do not carry the genes from "
            "which they were made. Name a folder that `drivora campaign run --out` wrote, or the "
            "id of the campaign"
        )
    if choice.kind is not StartKind.FAILURES:
        raise ConfigurationError(
            f"{folder} holds the failures of a campaign only; to start from its elites, name the "
            "campaign by its id"
        )
    try:
        told = _Exported.model_validate_json(file.read_bytes())
        document = read_stored(CampaignDocument, told.document)
    except (OSError, ValidationError) as error:
        raise ConfigurationError(
            f"{file} cannot be read as the results of a campaign: {str(error).splitlines()[0]}"
        ) from error
    # Those whose scenario was taken out of the folder are not wanted.
    kept = [one for one in told.candidates if (folder / f"{one.evaluation:06d}.json").is_file()]
    if not kept:
        why = (
            "none of its failures has its scenario in the folder"
            if told.candidates
            else "it found no failure, or was written by a version without genes; name the "
            "campaign by its id"
        )
        raise ConfigurationError(f"{file} has nothing to start from: {why}")
    counts: dict[int, int] = {}
    found = []
    for one in kept:
        counts[one.seed_number] = counts.get(one.seed_number, 0) + 1
        if counts[one.seed_number] <= choice.most:
            found.append(_Found(place=one.seed_number, values=one.values))
    return Earlier(
        title=f"campaign {told.id} ({told.name})",
        document=document,
        network_sha256=told.network_sha256,
        candidates=tuple(found),
    )
