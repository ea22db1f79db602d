"""The decisions, and parsing them from a model's answer."""

from __future__ import annotations

import re
from enum import StrEnum

DELIMITER = "####"
"""Delimiter between the reasons and the decision."""


class Decision(StrEnum):
    """A decision; in the order of DiLu's action ids, 0 to 4."""

    LEFT = "left"
    KEEP = "keep"
    RIGHT = "right"
    ACCELERATE = "accelerate"
    DECELERATE = "decelerate"


DECISIONS = tuple(Decision)
_WORD = re.compile(rf"\b({'|'.join(DECISIONS)})\b", re.IGNORECASE)


def decision_in(answer: str) -> Decision | None:
    """Returns the decision of an answer: the single one named after its last delimiter.

    Without a delimiter the whole answer is searched, as in DiLu.

    Returns:
        ``None`` if no decision is named there, or more than one.
    """
    named = {word.lower() for word in _WORD.findall(answer.split(DELIMITER)[-1])}
    return Decision(named.pop()) if len(named) == 1 else None
