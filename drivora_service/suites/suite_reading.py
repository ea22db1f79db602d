"""Reading a suite: the document and all its names, validated together."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from itertools import chain
from typing import Any, Literal

from pydantic import ValidationError

from drivora_service.errors import InvalidDocument, Problem
from drivora_service.scenario.document_problems import in_document_order, structural_problems
from drivora_service.scenario.structure import read_structure
from drivora_service.suites.named_parts import is_metric, items_of, unknown, unknown_oracles
from drivora_service.suites.suite import (
    Difficulty,
    MetricBounds,
    Suite,
    SuiteScenario,
)
from drivora_service.suites.suite_documents import (
    EXTENSION,
    ExpectationsDocument,
    SuiteDocument,
    SuiteScenarioDocument,
)
from drivora_service.suites.suite_failures import AGENT_FAILED

_MOST_BYTES = 256 << 20
"""Size of a document, which holds many scenarios."""


def read_suite(
    data: str | bytes | Mapping[str, Any],
    *,
    oracles: Collection[str],
    metrics: Collection[str],
    format: Literal["json", "yaml"] = "json",  # noqa: A002  # reads best in calls
) -> Suite:
    """Reads a suite, its scenarios included; their roads and agents are checked when they are run.

    Args:
        data: Text, or its parsed content.
        oracles: Names of the oracles that runs are judged by.
        metrics: Names of the metrics that describe runs.
        format: Language of the text; YAML without aliases and tags.

    Raises:
        InvalidDocument: The document has problems; all are listed, in document order.
    """

    def find_unknown_names(content: Mapping[str, Any]) -> Iterator[Problem]:
        return _unknown_names(content, oracles=oracles, metrics=metrics)

    document, content, odd = read_structure(
        data,
        SuiteDocument,
        format,
        what="a suite",
        most_bytes=_MOST_BYTES,
        further=find_unknown_names,
    )
    carried, problems = _read_carried_expectations(document)
    problems += [
        *odd,
        *_repeated_names(document),
        *find_unknown_names(content),
    ]
    if problems:
        raise InvalidDocument(in_document_order(problems, content))
    return Suite(
        name=document.name,
        description=document.description,
        scenarios=tuple(
            _scenario(document, one, carried[place]) for place, one in enumerate(document.scenarios)
        ),
        repetitions=document.repetitions,
    )


_NO_EXPECTATIONS = ExpectationsDocument()


def _read_carried_expectations(
    document: SuiteDocument,
) -> tuple[list[ExpectationsDocument], list[Problem]]:
    """Reads the expectations that the scenarios carry themselves."""
    carried: list[ExpectationsDocument] = []
    problems: list[Problem] = []
    for place, one in enumerate(document.scenarios):
        content = one.document.extensions.get(EXTENSION)
        expectations = _NO_EXPECTATIONS
        if content is not None:
            try:
                expectations = ExpectationsDocument.model_validate(content)
            except ValidationError as error:
                problems += [
                    replace(problem, pointer=_extension_place(place) + problem.pointer)
                    for problem in structural_problems(error, ExpectationsDocument, content)
                ]
        carried.append(expectations)
    return carried, problems


def _extension_place(place: int) -> str:
    return f"/scenarios/{place}/document/extensions/{EXTENSION}"


def _scenario(
    suite: SuiteDocument, one: SuiteScenarioDocument, carried: ExpectationsDocument
) -> SuiteScenario:
    oracles = next(
        (given for given in (one.oracles, carried.oracles, suite.oracles) if given is not None),
        None,
    )
    difficulty = one.difficulty or carried.difficulty
    return SuiteScenario(
        name=one.name,
        document=one.document,
        tags=tuple(dict.fromkeys((*suite.tags, *carried.tags, *one.tags))),
        oracles=None if oracles is None else frozenset(oracles),
        counts=one.counts or carried.counts or suite.counts,
        metrics={
            name: MetricBounds(at_least=bounds.at_least, at_most=bounds.at_most)
            for name, bounds in {**suite.metrics, **carried.metrics, **one.metrics}.items()
        },
        known_failures=tuple(
            known.known_failure for known in (*carried.known_failures, *one.known_failures)
        ),
        difficulty=None
        if difficulty is None
        else Difficulty(failed_by=difficulty.failed_by, passed_by=difficulty.passed_by),
    )


def _repeated_names(document: SuiteDocument) -> Iterator[Problem]:
    first: dict[str, int] = {}
    for place, one in enumerate(document.scenarios):
        if first.setdefault(one.name, place) != place:
            yield Problem(
                pointer=f"/scenarios/{place}/name",
                code="repeated_name",
                message=f"found {one.name!r} again (first at /scenarios/{first[one.name]}); names "
                "must be unique",
            )


def _unknown_names(
    content: Mapping[str, Any], *, oracles: Collection[str], metrics: Collection[str]
) -> Iterator[Problem]:
    """Yields unknown names in a suite, whose structure may have problems."""
    scenarios = items_of(content, "scenarios")
    documents = [_part(one, "document") for _, one in scenarios]
    egos = [_egos(one) for one in documents]
    yield from unknown_oracles(content, oracles)
    yield from _unknown_metrics("", content, metrics)
    yield from _unknown_egos("", content, list(dict.fromkeys(chain(*egos))))
    for (place, one), document, own in zip(scenarios, documents, egos, strict=True):
        carried = _part(_part(document, "extensions"), EXTENSION)
        for prefix, expected in (
            (f"/scenarios/{place}", one),
            (_extension_place(place), carried),
        ):
            yield from unknown_oracles(expected, oracles, prefix)
            yield from _unknown_metrics(prefix, expected, metrics)
            yield from _unknown_egos(prefix, expected, own)
            for index, known in items_of(expected, "known_failures"):
                name = known.get("oracle") if isinstance(known, Mapping) else None
                if isinstance(name, str) and name not in (AGENT_FAILED, *oracles):
                    pointer = f"{prefix}/known_failures/{index}/oracle"
                    yield unknown("oracle", name, (AGENT_FAILED, *oracles), pointer)


def _unknown_metrics(prefix: str, expected: Any, known: Collection[str]) -> Iterator[Problem]:
    for name in _part(expected, "metrics"):
        if not is_metric(name, known):
            yield unknown("metric", name, known, f"{prefix}/metrics/{name}")


def _unknown_egos(prefix: str, expected: Any, egos: Collection[str]) -> Iterator[Problem]:
    """Yields metrics of egos that do not exist: their bounds would always hold."""
    for name in _part(expected, "metrics"):
        _, bracket, ego = name.partition("[")
        if bracket and ego.removesuffix("]") not in egos:
            yield unknown("ego", ego.removesuffix("]"), egos, f"{prefix}/metrics/{name}")


def _part(content: Any, key: str) -> Mapping[str, Any]:
    """Returns the object at a key of another one; an empty one if there is none."""
    found = content.get(key) if isinstance(content, Mapping) else None
    return found if isinstance(found, Mapping) else {}


def _egos(document: Mapping[str, Any]) -> list[str]:
    """Returns the ids of the egos of a scenario, whose structure may have problems."""
    egos = (one for _, one in items_of(document, "ego_vehicles"))
    ids = (ego.get("id") for ego in egos if isinstance(ego, Mapping))
    return [one for one in ids if isinstance(one, str)]
