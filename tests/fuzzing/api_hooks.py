"""Hooks of schemathesis for the parts of the API that the schema does not describe."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

import schemathesis
from hypothesis import strategies as st
from schemathesis.core.parameters import ParameterLocation
from schemathesis.core.transport import Response

# A token is of one query, so that only the empty one fits every query; the others come by links.
schemathesis.openapi.format("page-token", st.just(""))


@schemathesis.serializer("application/x-ndjson")
def as_line(_context: Any, value: Any) -> bytes:
    """Writes a scenario as the one line of a batch."""
    return value if isinstance(value, bytes) else json.dumps(value).encode()


@dataclass(frozen=True, kw_only=True)
class _Query:
    """The query whose answer had a page token."""

    path: str
    parameters: dict[str, Any]


_queries: dict[str, _Query] = {}


@schemathesis.hook
def after_call(_context: Any, case: schemathesis.Case[Any], response: Response) -> None:
    """Keeps the query of a page token."""
    if not response.content or response.headers.get("content-type") != ["application/json"]:
        return
    answer = response.json()
    if isinstance(answer, dict) and (token := answer.get("next_page_token")):
        _queries[token] = _Query(path=case.formatted_path, parameters=dict(case.query))


@schemathesis.hook
def before_call(_context: Any, case: schemathesis.Case[Any], **_arguments: Any) -> None:
    """Mends valid requests that are refused for what no schema says.

    The two ends of a span are put in order. A page token gets the query that it is of; one of
    another path, which an answer had by chance, is taken out. An id of dots would be a step in the
    path of the address: the request would be for another operation.
    """
    for name, value in (case.path_parameters or {}).items():
        if value in (".", "..", ""):
            case.path_parameters[name] = "none"
    if case.meta is None or case.meta.is_negative_at(ParameterLocation.QUERY):
        return
    query = case.query
    ends = [query.get("first"), query.get("last")]
    if all(str(end).isdecimal() for end in ends):
        query["first"], query["last"] = sorted(ends, key=lambda end: int(str(end)))
    if token := query.get("page_token"):
        known = _queries.get(str(token))
        if known is None or known.path != case.formatted_path:
            query["page_token"] = ""
        else:
            query.clear()
            query.update(known.parameters | {"page_token": token})
