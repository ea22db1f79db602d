"""Reading a study: the document, and all its campaigns, validated together."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Literal

from pydantic import ValidationError

from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.document.campaign_documents import CampaignDocument, campaign_text
from drivora_service.campaigns.document.campaign_reading import (
    ValidCampaign,
    budget_of_seed,
    check_agent,
    check_oracles,
    check_scenario,
    check_tester,
    read_campaign,
)
from drivora_service.errors import InvalidDocument, Problem
from drivora_service.scenario.document_problems import in_document_order
from drivora_service.scenario.fields import MAX_SEED
from drivora_service.scenario.plain_data import MAX_LOOKED_AT
from drivora_service.scenario.structure import read_structure
from drivora_service.store.campaigns.campaign_records import NewCampaign, StudyCell
from drivora_service.studies.study_documents import (
    MAX_CAMPAIGNS,
    StudyAgentDocument,
    StudyDocument,
    StudyMethodDocument,
)

_MOST_BYTES = 32 << 20
"""Size of a document, which holds many scenarios."""

_LONGEST_NAME = 200
"""Characters of the name of a campaign."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ValidStudy:
    """A study that can be run.

    Attributes:
        document: The document, with defaults filled in.
        campaigns: In the order in which they begin: repetition by repetition, so that every
            scenario, agent and method has results early.
        genes: Numbers that describe a candidate; the most, if the campaigns differ.
        notes: Remarks on how the document was interpreted.
    """

    document: StudyDocument
    campaigns: tuple[NewCampaign, ...]
    genes: int
    notes: tuple[str, ...]

    @property
    def simulations(self) -> int:
        """Number of simulations of all campaigns together, at most."""
        return sum(campaign.budget for campaign in self.campaigns)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Combination:
    """A scenario, an agent and a method, by their places in the lists of the document."""

    scenario: int
    agent: int
    method: int


def read_study(
    data: str | bytes | Mapping[str, Any],
    catalogues: Catalogues,
    format: Literal["json", "yaml"] = "json",  # noqa: A002  # reads best in calls
) -> ValidStudy:
    """Reads a study and validates each of its campaigns, their spaces and testers included.

    Args:
        data: Text, or its parsed content.
        catalogues: Catalogues for the names.
        format: Language of the text; YAML without aliases and tags.

    Raises:
        InvalidDocument: The document has problems; all are listed, in document order.
        NetworkError: A network's file cannot be read.
    """
    document, content, odd = read_structure(
        data,
        StudyDocument,
        format,
        what="a study",
        most_bytes=_MOST_BYTES,
        further=partial(_problems_of_parts, catalogues),
    )
    problems = [
        *odd,
        *_repeated_labels(document),
        *_beyond_limits(document),
        *_missing_starts(document),
    ]
    if problems:
        raise InvalidDocument(in_document_order(problems, content))
    valid, genes, problems = _read_all(document, catalogues)
    if problems:
        raise InvalidDocument(in_document_order(problems, content))
    return ValidStudy(
        document=document,
        campaigns=tuple(_campaigns(document, valid)),
        genes=genes,
        notes=tuple(
            dict.fromkeys(
                _place_note(note, document, one)
                for one, campaign in valid.items()
                for note in campaign.notes
            )
        ),
    )


def _problems_of_parts(catalogues: Catalogues, content: Mapping[str, Any]) -> Iterator[Problem]:
    """Yields what is wrong with the well-formed parts of a study whose structure has problems."""
    for place, item in _items(content, "scenarios"):
        if isinstance(item, Mapping) and isinstance(item.get("document"), Mapping):
            pointer = f"/scenarios/{place}/document"
            yield from check_scenario(pointer, item["document"], catalogues, "")[1]
    for place, item in _items(content, "agents"):
        with contextlib.suppress(ValidationError):
            agent = StudyAgentDocument.model_validate(item)
            for problem in check_agent(agent, catalogues.agents):
                inside = problem.pointer.removeprefix("/agent")
                yield replace(problem, pointer=f"/agents/{place}{inside}")
    budget = budget_of_seed(content)
    for place, item in _items(content, "methods"):
        with contextlib.suppress(ValidationError):
            method = StudyMethodDocument.model_validate(item)
            for problem in check_tester(method, catalogues.testers, budget):
                inside = problem.pointer.removeprefix("/tester")
                yield replace(problem, pointer=f"/methods/{place}{inside}")
    names = [name for _, name in _items(content, "oracles")]
    yield from check_oracles(names, catalogues.oracles, ())


def _items(content: Mapping[str, Any], key: str) -> Iterator[tuple[int, Any]]:
    """Yields the items of a list with their places; nothing if it is no list."""
    found = content.get(key)
    if isinstance(found, list | tuple):
        yield from enumerate(found[:MAX_LOOKED_AT])


def _repeated_labels(document: StudyDocument) -> Iterator[Problem]:
    for key, labels in (
        ("scenarios", document.scenario_labels),
        ("agents", document.agent_labels),
        ("methods", document.method_labels),
    ):
        for place, label in enumerate(labels):
            if label in labels[:place]:
                message = f"found {label!r} again; give each a `label` of its own"
                yield Problem(
                    pointer=f"/{key}/{place}/label", code="repeated_label", message=message
                )


def _missing_starts(document: StudyDocument) -> Iterator[Problem]:
    """Yields the scenarios for which a method has no candidate to start from, and the reverse."""
    labels = document.scenario_labels
    for place, method in enumerate(document.methods):
        if method.start_from is None:
            continue
        given = dict.fromkeys(one.seed for one in method.start_from.candidates)
        for name in (*(one for one in labels if one not in given), *given):
            if name in labels and name in given:
                continue
            what = "no candidate of scenario" if name in labels else "a candidate of no scenario:"
            yield Problem(
                pointer=f"/methods/{place}/start_from/candidates",
                code="start_scenarios",
                message=f"found {what} {name!r}; `seed` of each names a scenario of the study, and "
                "each scenario needs one",
            )


def _beyond_limits(document: StudyDocument) -> Iterator[Problem]:
    if document.seed + document.repetitions - 1 > MAX_SEED:
        message = f"found {document.seed}; the last repetition's seed would be above {MAX_SEED}"
        yield Problem(pointer="/seed", code="seed_too_large", message=message)
    if document.size > MAX_CAMPAIGNS:
        yield Problem(
            pointer="",
            code="too_many_campaigns",
            message=f"found {document.size} campaigns; at most {MAX_CAMPAIGNS} are allowed: make "
            "several studies",
        )


def _read_all(
    document: StudyDocument, catalogues: Catalogues
) -> tuple[dict[_Combination, ValidCampaign], int, list[Problem]]:
    """Reads the first campaign of each combination.

    Returns:
        The valid campaigns, the greatest number of their genes, and problems at their places.
    """
    valid: dict[_Combination, ValidCampaign] = {}
    genes = 0
    problems: dict[Problem, None] = {}
    refused: set[tuple[str, int]] = set()
    for scenario in range(len(document.scenarios)):
        for agent in range(len(document.agent_labels)):
            for method in range(len(document.methods)):
                places = (("scenario", scenario), ("agent", agent), ("method", method))
                if refused.intersection(places):
                    # What is wrong with a part is found once.
                    continue
                one = _Combination(scenario=scenario, agent=agent, method=method)
                try:
                    valid[one] = _read(document, one, catalogues)
                    if agent == 0:
                        # What the space and the tester refuse does not depend on the agent.
                        genes = max(genes, _count_genes(valid[one], catalogues))
                except InvalidDocument as error:
                    for problem in error.problems:
                        placed, part = _place_problem(problem, document, one)
                        problems[placed] = None
                        if part in dict(places):
                            refused.add((part, dict(places)[part]))
    return valid, genes, list(problems)


def _count_genes(valid: ValidCampaign, catalogues: Catalogues) -> int:
    """Returns the number of genes of a campaign, by preparing its search."""
    # Imported here: it needs the code of all testers.
    from drivora_service.campaigns.search.search_preparation import prepare_search

    return prepare_search(valid, catalogues, run_prefix="").genes


def _read(document: StudyDocument, one: _Combination, catalogues: Catalogues) -> ValidCampaign:
    scenario = document.scenarios[one.scenario]
    space = document.space if scenario.space is None else scenario.space
    content: dict[str, Any] = {
        "name": _name(document, one, 1),
        "tester": _tester(document, one),
        "scenario": scenario.document.model_dump(mode="json", exclude_none=True),
        "space": space.model_dump(mode="json"),
        "budget": document.budget.model_dump(),
        "counts": document.counts,
        "oracles": document.oracles,
        "seed": document.seed,
        "lookahead": document.lookahead,
    }
    feedback = document.methods[one.method].minimises or document.feedback
    if feedback is not None:
        content["feedback"] = feedback.model_dump(mode="json", exclude_none=True)
    if document.agents:
        content["agent"] = document.agents[one.agent].model_dump(exclude={"label"})
    return read_campaign(content, catalogues)


def _tester(document: StudyDocument, one: _Combination) -> dict[str, Any]:
    """Returns the tester of a campaign, with the candidates of its scenario to start from."""
    method = document.methods[one.method]
    content: dict[str, Any] = method.model_dump(exclude={"label", "minimises"}, exclude_none=True)
    if method.start_from is not None:
        # A campaign of a study has one seed scenario, which needs no name.
        own = method.start_from.of_seed(document.scenario_labels[one.scenario])
        content["start_from"]["candidates"] = [{"values": candidate.values} for candidate in own]
    return content


def _place_problem(
    problem: Problem, document: StudyDocument, one: _Combination
) -> tuple[Problem, str]:
    """Returns a problem of a campaign at its place in the study, and the part that it is of."""
    _, _, rest = problem.pointer.partition("/")
    key, slash, inside = rest.partition("/")
    own_space = document.scenarios[one.scenario].space is not None
    own_feedback = document.methods[one.method].minimises is not None
    prefix, part = {
        "scenario": (f"/scenarios/{one.scenario}/document", "scenario"),
        "agent": (f"/agents/{one.agent}", "agent"),
        "tester": (f"/methods/{one.method}", "method"),
        "feedback": (
            f"/methods/{one.method}/minimises" if own_feedback else "/feedback",
            "method",
        ),
        "space": (f"/scenarios/{one.scenario}/space" if own_space else "/space", "scenario"),
    }.get(key, (f"/{key}" if key else "", ""))
    message = problem.message
    if problem.pointer in ("/space", "/tester"):
        # It is the combination that does not work, and not the part by itself.
        what = document.scenario_labels[one.scenario]
        message, part = f"with scenario {what!r}: {message}", ""
    return replace(problem, pointer=prefix + slash + inside, message=message), part


def _place_note(note: str, document: StudyDocument, one: _Combination) -> str:
    """Returns a note on a campaign at its place in the study, if it has one."""
    if not note.startswith("/"):
        return note
    pointer, _, message = note.partition(": ")
    problem = Problem(pointer=pointer, code="note", message=message)
    placed, _ = _place_problem(problem, document, one)
    return f"{placed.pointer}: {placed.message}"


def _campaigns(
    document: StudyDocument, valid: Mapping[_Combination, ValidCampaign]
) -> Iterator[NewCampaign]:
    # Imported here: it needs the code of all testers.
    from drivora_service.campaigns.records.stored_campaigns import new_campaign

    first = {one: new_campaign(campaign) for one, campaign in valid.items()}
    for repetition in range(1, document.repetitions + 1):
        for one, campaign in valid.items():
            name = _name(document, one, repetition)
            own = {"name": name, "seed": document.seed + repetition - 1}
            changed: CampaignDocument = campaign.document.model_copy(update=own)
            yield replace(
                first[one],
                name=name,
                document=campaign_text(changed),
                cell=StudyCell(
                    scenario=document.scenario_labels[one.scenario],
                    agent=document.agent_labels[one.agent],
                    method=document.method_labels[one.method],
                    repetition=repetition,
                ),
            )


def _name(document: StudyDocument, one: _Combination, repetition: int) -> str:
    parts: Sequence[str] = (
        document.name,
        document.scenario_labels[one.scenario],
        *((document.agent_labels[one.agent],) if document.agents else ()),
        document.method_labels[one.method],
        str(repetition),
    )
    return ", ".join(parts)[:_LONGEST_NAME]
