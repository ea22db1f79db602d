"""Edits of a scenario document: places that are removed or get another value, several at once."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from pydantic import ValidationError

from drivora_service.scenario.documents import ScenarioDocument

Place = tuple[str | int, ...]
"""Keys and list indices from the document's root to a part of it."""

Content = Mapping[str, Any]
"""A document as plain data, without the values that are the default."""


@dataclass(frozen=True, slots=True)
class Removed:
    """Stands for the value of a place that is removed."""


REMOVED = Removed()


@dataclass(frozen=True, slots=True, kw_only=True)
class Edit:
    """One simplification of a document.

    Attributes:
        changes: Places of the document that it is made for, with their new values.
        label: What it does, in a few words.
    """

    changes: tuple[tuple[Place, Any], ...]
    label: str


def removal(place: Place, label: str) -> Edit:
    """Returns the edit that removes a place."""
    return Edit(changes=((place, REMOVED),), label=label)


def content_of(document: ScenarioDocument) -> Content:
    """Returns a document as plain data, without the values that are the default."""
    content: dict[str, Any] = document.model_dump(
        mode="json", exclude_defaults=True, exclude_none=True
    )
    return content


def document_of(content: Content) -> ScenarioDocument | None:
    """Returns plain data as a document; ``None`` if it is none."""
    try:
        return ScenarioDocument.model_validate(content)
    except ValidationError:
        return None


def apply_edits(document: ScenarioDocument, edits: Iterable[Edit]) -> ScenarioDocument | None:
    """Returns a document after edits that were made for it; ``None`` if the result is none.

    New values are set before places are removed, so that the indices of both are those of the
    document. An edit of a part that another one removes has no effect.
    """
    content = json.loads(json.dumps(content_of(document)))
    removed: dict[Place, None] = {}
    for edit in edits:
        for place, value in edit.changes:
            if isinstance(value, Removed):
                removed[place] = None
            else:
                _parent(content, place)[place[-1]] = value
    # The last one of a list first: the indices of the others stay.
    for place in sorted(removed, key=_order, reverse=True):
        del _parent(content, place)[place[-1]]
    return document_of(content)


def _parent(content: Any, place: Place) -> Any:
    for key in place[:-1]:
        content = content[key] if isinstance(key, int) else content.setdefault(key, {})
    return content


def _order(place: Place) -> tuple[tuple[int, str], ...]:
    # Longer places come later, so that parts are removed before what they are parts of.
    return tuple((key, "") if isinstance(key, int) else (-1, key) for key in place)
