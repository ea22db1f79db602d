"""Names for runs and batches: unique, and in the order of their making."""

from __future__ import annotations

import secrets
import time


def new_id() -> str:
    """Makes an id of 24 hexadecimal digits: milliseconds since 1970, then 48 random bits."""
    return f"{time.time_ns() // 1_000_000:012x}{secrets.token_hex(6)}"
