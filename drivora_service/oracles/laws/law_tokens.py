"""Formulas as tokens, and the error that names a place in a formula."""

from __future__ import annotations

import re
from dataclasses import dataclass

MAX_LENGTH = 4000
"""Greatest number of characters of a formula."""

WORDS = {
    "always", "eventually", "historically", "once", "until", "not", "and", "or", "implies",
}  # fmt: skip
"""Words of the language, which no signal or parameter can be named."""

_SAME = {"implies": "->", "&&": "and", "&": "and", "||": "or", "|": "or", "!": "not"}
_TOKEN = re.compile(
    r"(?P<space>\s+|\#[^\n]*)"
    r"|(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)"
    r"|(?P<name>[A-Za-z_][A-Za-z0-9_]*)"
    r"|(?P<sign>->|<=|>=|&&|\|\||[<>()\[\]:+\-*/&|!])"
)


class FormulaError(ValueError):
    """A formula that cannot be used.

    Attributes:
        offset: Character of the formula at which the mistake is, from 0.
    """

    def __init__(self, message: str, offset: int) -> None:
        self.offset = offset
        super().__init__(message)


@dataclass(frozen=True, slots=True, kw_only=True)
class Token:
    """A token of a formula.

    Attributes:
        kind: ``number``, ``name``, ``sign`` (with the words of the language) or ``end``.
        text: As written, but one spelling of each operator.
        offset: Character at which it begins, from 0.
        stop: Character after its last.
    """

    kind: str
    text: str
    offset: int
    stop: int

    def __str__(self) -> str:
        """Returns the token for messages."""
        return "the end of the formula" if self.kind == "end" else repr(self.text)


def tokenize(text: str) -> tuple[Token, ...]:
    """Splits a formula into tokens; the last is of the kind ``end``.

    Raises:
        FormulaError: It is too long, or has a character that no token begins with.
    """
    if len(text) > MAX_LENGTH:
        raise FormulaError(
            f"found {len(text)} characters; a formula has at most {MAX_LENGTH}", MAX_LENGTH
        )
    tokens: list[Token] = []
    offset = 0
    while offset < len(text):
        match = _TOKEN.match(text, offset)
        if match is None:
            raise FormulaError(_odd_character(text[offset : offset + 2]), offset)
        kind, word = match.lastgroup or "", match.group()
        if kind != "space":
            if word in WORDS or word in _SAME:
                kind = "sign"
            tokens.append(
                Token(kind=kind, text=_SAME.get(word, word), offset=offset, stop=match.end())
            )
        offset = match.end()
    return (*tokens, Token(kind="end", text="", offset=len(text), stop=len(text)))


def _odd_character(found: str) -> str:
    if found[0] == "=" or found == "!=":
        return (
            f"found {found!r}; measured values are compared by <=, <, >= or >, flags by their name "
            "or `not` and their name"
        )
    return (
        f"found {found[0]!r}; allowed are names, numbers, ( ) [ : ] + - * / < <= > >= -> and the "
        f"words {', '.join(sorted(WORDS))}"
    )
