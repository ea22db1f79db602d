"""Values of parameters as text for people: long ones shortened, with their number of elements."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

_LONGEST = 80
"""Characters of a value that is shown whole."""

_FIRST = 2
"""Elements that are shown of a longer list or mapping."""


def short_value(value: Any, *, longest: int = _LONGEST) -> str:
    """Returns a value as JSON text; a long list is shown as ``[0.1, 0.2, … 500 values]``.

    Args:
        value: A value as in JSON.
        longest: Characters of a value that is shown whole; more remain only of short elements.
    """
    text = json.dumps(value, ensure_ascii=False)
    if len(text) <= longest:
        return text
    if isinstance(value, str):
        return f'{text[: longest - 2]}…"'
    if isinstance(value, Mapping):
        shown = [
            f"{json.dumps(key, ensure_ascii=False)}: {short_value(one, longest=longest // 3)}"
            for key, one in list(value.items())[:_FIRST]
        ]
        return f"{{{_join(shown, len(value))}}}"
    if isinstance(value, Sequence):
        shown = [short_value(one, longest=longest // 3) for one in value[:_FIRST]]
        return f"[{_join(shown, len(value))}]"
    return text


def _join(shown: Sequence[str], count: int) -> str:
    """Joins the elements that are shown, and the number of all unless these are all."""
    if count <= len(shown):
        return ", ".join(shown)
    return f"{', '.join(shown)}, … {count} values"
