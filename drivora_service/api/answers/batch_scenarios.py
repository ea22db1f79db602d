"""The scenarios of a batch: bare documents, or documents with labels.

An item with a label is ``{"label": "crossing-17", "scenario": {…}}``, and may have a ``seed`` and
``failures``. No scenario has a ``label`` or ``scenario``: one of them shows that it is one.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, TypeVar

from pydantic import ValidationError

from drivora_service.api.schemas.batches import LabelledScenario
from drivora_service.errors import InvalidDocument, Problem
from drivora_service.oracles.verdicts.failure_definition import FailureDefinition
from drivora_service.scenario.document_problems import structural_problems
from drivora_service.scenario.plain_data import plain_data, refusal

T = TypeVar("T")

_KEYS = ("label", "scenario")
_QUOTED = tuple(f'"{key}"'.encode() for key in _KEYS)
_PLACE = "/scenario"


@dataclass(frozen=True, slots=True, kw_only=True)
class BatchScenario:
    """A scenario of a batch.

    Attributes:
        document: The scenario, parsed or not; ``None``: its item has none.
        label: Display name of its run.
        seed: Seed of its run; ``None``: that of the request, or as documented.
        failures: What is a failure of its run; ``None``: what the request says.
        place: JSON pointer to the document in its item; "" if that is the document itself.
        problems: Problems of the item; the document may have others.
    """

    document: bytes | Mapping[str, Any] | None
    label: str = ""
    seed: int | None = None
    failures: FailureDefinition | None = None
    place: str = ""
    problems: tuple[Problem, ...] = ()

    def check_document(self, check: Callable[[bytes | Mapping[str, Any]], T]) -> T:
        """Returns the result of a check of the document.

        Args:
            check: Raises ``InvalidDocument`` with pointers into the document.

        Raises:
            InvalidDocument: With every problem, also of the item; pointers are into the item.
        """
        problems = self.problems
        if self.document is not None:
            try:
                result = check(self.document)
            except InvalidDocument as error:
                if not self.place:
                    raise
                known = {(problem.pointer, problem.code) for problem in problems}
                found = (replace(p, pointer=self.place + p.pointer) for p in error.problems)
                problems += tuple(p for p in found if (p.pointer, p.code) not in known)
            else:
                if not problems:
                    return result
        raise InvalidDocument(problems)


def read_batch_scenario(item: object) -> BatchScenario:
    """Reads an item of a batch.

    Args:
        item: A value of a JSON list, or a line of NDJSON. A line is parsed only if it has the words
            of an item with a label.

    Raises:
        InvalidDocument: It is not an object, or a line that may have a label cannot be read.
    """
    if isinstance(item, bytes):
        if not any(word in item for word in _QUOTED):
            return BatchScenario(document=item)
        # With the problems of the scenario that are not seen once it is parsed: repeated keys.
        content, problems = plain_data(item)
        if not _has_label(content):
            return BatchScenario(document=item)
        return _read_labelled(content, problems)
    if not isinstance(item, Mapping):
        raise refusal("not_an_object", "a scenario is one object with keys")
    if not _has_label(item):
        return BatchScenario(document=item)
    _, problems = plain_data({key: value for key, value in item.items() if key != "scenario"})
    return _read_labelled(item, problems)


def _has_label(content: Mapping[str, Any]) -> bool:
    return any(key in content for key in _KEYS)


def _read_labelled(content: Mapping[str, Any], problems: list[Problem]) -> BatchScenario:
    label, seed, failures = "", None, None
    try:
        read = LabelledScenario.model_validate(content)
        label, seed = read.label, read.seed
        failures = None if read.failures is None else read.failures.definition
    except ValidationError as error:
        odd = {problem.pointer for problem in problems}
        structural = structural_problems(error, LabelledScenario, content)
        problems += [problem for problem in structural if problem.pointer not in odd]
    document = content.get("scenario")
    return BatchScenario(
        document=document if isinstance(document, Mapping) else None,
        label=label,
        seed=seed,
        failures=failures,
        place=_PLACE,
        problems=tuple(problems),
    )
