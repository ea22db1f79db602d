"""The harness, and the correct answers of a parser."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from drivora_service.errors import DrivoraError, InvalidDocument
from drivora_service.scenario.document_problems import tokens
from drivora_service.scenario.plain_data import pointer


@dataclass(frozen=True, slots=True, kw_only=True)
class Harness:
    """A parser under test.

    Attributes:
        parse: Hands bytes to the parser as a user's file reaches it. Returns whether the input was
            read; False: it was refused correctly. Whatever it raises is a finding.
        seeds: Makes the inputs that mutation begins with, by name; nothing is made on import. All
            of them are read.
        words: Tokens that the parser knows, besides those of the seeds.
        max_length: Bytes of an input.
    """

    name: str
    parse: Callable[[bytes], bool]
    seeds: Callable[[], Mapping[str, bytes]]
    words: tuple[str, ...] = ()
    max_length: int = 4096


def by_name(*harnesses: Harness) -> Mapping[str, Harness]:
    """Names the harnesses of a module."""
    return {harness.name: harness for harness in harnesses}


class BadRefusal(AssertionError):
    """A refusal that does not tell the user what is wrong, or where."""


def check_refusal(error: DrivoraError, content: Any = None) -> None:
    """Checks that a refusal has a message and, for documents, places that the document has.

    Args:
        error: What the parser raised.
        content: The document as plain data; ``None``: it has none, so places are not looked up.

    Raises:
        BadRefusal: It has none.
    """
    if not str(error).strip():
        raise BadRefusal(f"{type(error).__name__} without a message")
    if not isinstance(error, InvalidDocument):
        return
    if not error.problems:
        raise BadRefusal("a refusal without a problem")
    for problem in error.problems:
        if not problem.message.strip() or not problem.code:
            raise BadRefusal(f"a problem without a message: {problem!r}")
        if content is not None and not has_place(content, problem.pointer):
            raise BadRefusal(f"no such place: {problem!r}")


def has_place(content: Any, place: str) -> bool:
    """Returns whether a JSON pointer leads to a place of a document, or to what misses in one."""
    if place == "":
        return True
    if not place.startswith("/"):
        return False
    steps = tokens(place, content)
    if pointer(steps) != place:
        return False
    for step in steps[:-1]:
        try:
            content = content[step]
        except (KeyError, IndexError, TypeError):
            return False
    return isinstance(content, dict | list)
