"""Reading a document of any kind: its text, its structure, and all problems of both."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any, Literal, TypeVar

from pydantic import BaseModel, ValidationError

from drivora_service.errors import InvalidDocument, Problem
from drivora_service.scenario.document_problems import in_document_order, structural_problems
from drivora_service.scenario.plain_data import MAX_DOCUMENT_BYTES, plain_data

M = TypeVar("M", bound=BaseModel)


def read_structure(
    data: str | bytes | Mapping[str, Any],
    model: type[M],
    format: Literal["json", "yaml"],  # noqa: A002  # as the readers of documents have it
    *,
    what: str,
    most_bytes: int = MAX_DOCUMENT_BYTES,
    further: Callable[[Mapping[str, Any]], Iterable[Problem]] = lambda _content: (),
) -> tuple[M, dict[str, Any], list[Problem]]:
    """Returns a document, its content, and the problems that its structure does not show.

    Args:
        data: Text, or its parsed content.
        model: Kind of the document.
        format: Language of the text; YAML without aliases and tags.
        what: What is expected, for messages.
        most_bytes: Size of a text of JSON.
        further: Finds further problems of a content whose structure has problems, of any types.

    Raises:
        InvalidDocument: The text cannot be read, or its structure has problems; all are listed, in
            document order.
    """
    content, odd = plain_data(data, format, what=what, most_bytes=most_bytes)
    try:
        return model.model_validate(content), content, odd
    except ValidationError as error:
        known = {problem.pointer for problem in odd}
        structural = structural_problems(error, model, content)
        problems = [*odd, *(p for p in structural if p.pointer not in known)]
        known |= {problem.pointer for problem in structural}
        problems += [p for p in further(content) if p.pointer not in known]
        raise InvalidDocument(in_document_order(problems, content)) from error
