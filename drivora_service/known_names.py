"""Names that were not found: the most similar one, and those that there are."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence
from functools import lru_cache

_LONGEST_GUESS = 80
"""A longer name is not a typing error, and the search time grows with its length."""

_MOST_LISTED = 60
"""Names that one message lists; more would hide the message itself."""


def unknown_name_message(kind: str, name: str, known: Iterable[str]) -> str:
    """Returns the message about a name that is not in a catalogue.

    Args:
        kind: Kind of the name: ``agent``.
        name: The name that was given.
        known: All names that there are.
    """
    names = tuple(known)
    advice = advise_name(name, names)
    if not advice:
        return f"unknown {kind} {name[:_LONGEST_GUESS]!r}"
    return f"unknown {kind} {name[:_LONGEST_GUESS]!r}; {advice}"


def advise_name(name: str, known: Iterable[str], *, word: str = "known") -> str:
    """Returns the most similar name, if one is similar enough, and all names; "" without any.

    Args:
        name: The name that was given.
        known: All names that there are.
        word: Introduces the list of names: ``known`` or ``allowed``.
    """
    names = tuple(known)
    if not names:
        return ""
    close = similar_names(name, names)
    if close:
        return f"did you mean {close[0]!r}? {word.capitalize()}: {list_names(names)}"
    return f"{word}: {list_names(names)}"


def list_names(names: Sequence[str]) -> str:
    """Returns names with commas; of very many the first ones and their number."""
    if len(names) <= _MOST_LISTED:
        return ", ".join(names)
    return f"{', '.join(names[:_MOST_LISTED])}, … ({len(names)} in all)"


def similar_names(name: str, known: Iterable[str], *, similar: float = 0.6) -> tuple[str, ...]:
    """Returns the most similar of the known names, if any is similar enough.

    Args:
        name: The name that was given.
        known: All names that there are.
        similar: Least similarity, 0 to 1; see :func:`difflib.get_close_matches`.
    """
    return _similar(name, tuple(known), similar) if len(name) <= _LONGEST_GUESS else ()


@lru_cache(maxsize=4096)
def _similar(name: str, known: tuple[str, ...], similar: float) -> tuple[str, ...]:
    """Finds similar names; cached, as the documents of a batch often have the same mistakes."""
    by_lower: dict[str, str] = {}
    for one in known:
        by_lower.setdefault(one.lower(), one)
    close = difflib.get_close_matches(name.lower(), by_lower, n=1, cutoff=similar)
    return tuple(by_lower[one] for one in close)
