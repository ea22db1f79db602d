"""What may be decided, and finding it in a model's answer."""

from __future__ import annotations

import re
from enum import StrEnum

DELIMITER = "####"
"""Stands between the reasons and the decision."""


class Decision(StrEnum):
    """One of five; in the order of DiLu's action ids, 0 to 4."""

    LEFT = "left"
    KEEP = "keep"
    RIGHT = "right"
    ACCELERATE = "accelerate"
    DECELERATE = "decelerate"


DECISIONS = tuple(Decision)
_WORD = re.compile(rf"\b({'|'.join(DECISIONS)})\b", re.IGNORECASE)


def decision_in(answer: str) -> Decision | None:
    """Returns what an answer decides: the one decision named behind its last delimiter.

    Where there is no delimiter the whole answer is looked at, as DiLu does.

    Returns:
        ``None`` where no decision is named there, or more than one.
    """
    named = {word.lower() for word in _WORD.findall(answer.split(DELIMITER)[-1])}
    return Decision(named.pop()) if len(named) == 1 else None
