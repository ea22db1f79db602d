"""Calls of a service as values: the same for every client."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from pathlib import Path
from typing import Any, Generic, Literal, TypeVar
from urllib.parse import quote

T = TypeVar("T")

Document = str | bytes | Mapping[str, Any]
"""A scenario or a campaign: its text, or what a JSON text stands for."""
Language = Literal["json", "yaml"]
"""In which the text of a document is written."""
Query = Mapping[str, object]
"""Parameters by name. ``None``, "" and an empty sequence are left out; a sequence is repeated."""

_MOST_ITEMS = 500
"""Of a page."""


class ObservationForm(StrEnum):
    """Media type of what a run recorded."""

    PARQUET = "application/vnd.apache.parquet"
    NDJSON = "application/x-ndjson"
    ARROW = "application/vnd.apache.arrow.stream"


@dataclass(frozen=True, slots=True, kw_only=True)
class Call(Generic[T]):
    """One request and the type of its answer.

    Attributes:
        template: Path, with the names of ``places`` in braces.
        places: Values for the placeholders of the path, by name.
        query: See :data:`Query`.
        body: ``None`` for requests without; a file is sent as it is read.
        headers: Besides those of every request.
        answer: Type that the answer is read as; ``bytes`` and ``str`` stand for what was sent.
        is_repeatable: Whether it may be sent again where it is not known whether it was done.
        is_once: Whether an ``Idempotency-Key`` makes it repeatable.
        accepted: Statuses of answers besides 2xx.
        answer_s: Seconds for which its answer is waited for; ``None``: as for all calls.
    """

    method: Literal["GET", "POST", "DELETE"]
    template: str
    places: Mapping[str, str | int] = field(default_factory=dict)
    query: Query = field(default_factory=dict)
    body: bytes | Path | None = None
    headers: Mapping[str, str] = field(default_factory=dict)
    answer: type[T]
    is_repeatable: bool
    is_once: bool = False
    accepted: frozenset[int] = frozenset()
    answer_s: float | None = None

    @property
    def path(self) -> str:
        """The path with its places filled in."""
        places = {name: quote(str(value), safe="") for name, value in self.places.items()}
        return self.template.format(**places)

    @property
    def parameters(self) -> tuple[tuple[str, str], ...]:
        """The parameters of the query as they are sent."""
        return tuple(
            (name, _text(value)) for name, given in self.query.items() for value in _values(given)
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Listing(Generic[T]):
    """A list that comes in pages.

    Attributes:
        first: Call of the first page.
        item: Type of its items.
        most: Items that are wanted; ``None``: all.
    """

    first: Call[Any]
    item: type[T]
    most: int | None

    def page(self, token: str, *, taken: int) -> Call[Any]:
        """Returns the call of a page.

        Args:
            token: Of the page before; "" for the first one.
            taken: Items that came before.
        """
        limit = _MOST_ITEMS if self.most is None else min(_MOST_ITEMS, self.most - taken)
        return replace(self.first, query={**self.first.query, "limit": limit, "page_token": token})


def get(
    template: str,
    answer: type[T],
    *,
    query: Query | None = None,
    accept: str = "",
    accepted: frozenset[int] = frozenset(),
    **places: str | int,
) -> Call[T]:
    """Returns a call that only reads."""
    return Call(
        method="GET",
        template=template,
        places=places,
        query=query or {},
        headers={"Accept": accept} if accept else {},
        answer=answer,
        is_repeatable=True,
        accepted=accepted,
    )


def act(
    template: str,
    answer: type[T],
    *,
    given: Mapping[str, object] | None = None,
    **places: str | int,
) -> Call[T]:
    """Returns a call that changes what is there; ``given`` is its body, as JSON."""
    return Call(
        method="POST",
        template=template,
        places=places,
        body=None if given is None else json.dumps(given).encode(),
        headers={} if given is None else {"Content-Type": "application/json"},
        answer=answer,
        is_repeatable=False,
    )


def post(
    template: str,
    answer: type[T],
    body: bytes,
    *,
    language: Language = "json",
    query: Query | None = None,
    only_checks: bool = False,
    **places: str | int,
) -> Call[T]:
    """Returns a call with a document: one that queues something, or only checks the document."""
    return Call(
        method="POST",
        template=template,
        places=places,
        query=query or {},
        body=body,
        headers={"Content-Type": f"application/{language}"},
        answer=answer,
        is_repeatable=only_checks,
        is_once=not only_checks,
    )


def make_listing(
    template: str, item: type[T], limit: int | None, *, query: Query | None = None, **places: str
) -> Listing[T]:
    """Returns a list of at most ``limit`` items; ``None``: all."""
    from drivora_service.store.runs.run_records import Page

    page: Any = Page
    first: Call[Any] = Call(
        method="GET",
        template=template,
        places=places,
        query={**(query or {}), "limit": None, "page_token": None},
        answer=page[item],
        is_repeatable=True,
    )
    return Listing(first=first, item=item, most=limit)


def document_bytes(document: Document) -> bytes:
    """Returns a document as the body of a request."""
    if isinstance(document, bytes):
        return document
    return (document if isinstance(document, str) else json.dumps(document)).encode()


def _values(given: object) -> Sequence[object]:
    if isinstance(given, list | tuple | set | frozenset):
        return [value for value in given if value not in (None, "")]
    return [] if given is None or given == "" else [given]


def _text(value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)
