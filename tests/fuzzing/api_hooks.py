"""What the fuzzing of the API must know that no schema says; loaded by schemathesis."""

from __future__ import annotations

import json
from typing import Any

import schemathesis
from hypothesis import strategies as st

# A token is of one query, so that only the empty one fits every query; the others come by links.
schemathesis.openapi.format("page-token", st.just(""))


@schemathesis.serializer("application/x-ndjson")
def as_line(_context: Any, value: Any) -> bytes:
    """Writes a scenario as the one line of a batch."""
    return value if isinstance(value, bytes) else json.dumps(value).encode()
