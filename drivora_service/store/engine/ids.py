"""Ids of runs and batches: unique, and ordered by time of creation."""

from __future__ import annotations

import secrets
import time


def new_id() -> str:
    """Returns an id of 24 hexadecimal digits: milliseconds since 1970, then 48 random bits."""
    return f"{time.time_ns() // 1_000_000:012x}{secrets.token_hex(6)}"
