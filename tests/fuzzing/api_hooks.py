"""What the fuzzing of the API must know that no schema says; loaded by schemathesis."""

from __future__ import annotations

import json
from typing import Any

import schemathesis
from hypothesis import strategies as st
from schemathesis.core.parameters import ParameterLocation
from schemathesis.generation.meta import TestPhase

# A token is of one query, so that only the empty one fits every query; the others come by links.
schemathesis.openapi.format("page-token", st.just(""))


@schemathesis.serializer("application/x-ndjson")
def as_line(_context: Any, value: Any) -> bytes:
    """Writes a scenario as the one line of a batch."""
    return value if isinstance(value, bytes) else json.dumps(value).encode()


@schemathesis.hook
def before_call(_context: Any, case: schemathesis.Case[Any], **_arguments: Any) -> None:
    """Takes the token of another query, which an answer had by chance, out of a valid request."""
    meta = case.meta
    if meta is None or meta.phase.name is TestPhase.STATEFUL or "page_token" not in case.query:
        return
    if not meta.is_negative_at(ParameterLocation.QUERY):
        case.query["page_token"] = ""
