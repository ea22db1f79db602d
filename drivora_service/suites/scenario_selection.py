"""Choosing scenarios of a suite: by names and tags, and in shards."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass

from drivora_service.errors import ConfigurationError
from drivora_service.suites.suite import SuiteScenario

_TOKEN = re.compile(r"\s*([()]|[^\s()]+)")
_SHARD = re.compile(r"([1-9][0-9]{0,3})/([1-9][0-9]{0,3})")

_DEEPEST = 50
"""Most parentheses around each other."""

Condition = Callable[[SuiteScenario], bool]


@dataclass(frozen=True, slots=True, kw_only=True)
class Shard:
    """One of several parts of a suite.

    Attributes:
        number: From 1.
        of: Number of parts.
    """

    number: int
    of: int

    def __str__(self) -> str:
        """Returns the part as it is given, such as ``1/4``."""
        return f"{self.number}/{self.of}"


def read_shard(text: str) -> Shard:
    """Reads ``NUMBER/OF``.

    Raises:
        ConfigurationError: It is not of that form, or there is no such part.
    """
    match = _SHARD.fullmatch(text)
    if match is None or int(match[1]) > int(match[2]):
        raise ConfigurationError(f"--shard {text!r}: give the number of a part, such as 1/4 to 4/4")
    return Shard(number=int(match[1]), of=int(match[2]))


def choose(
    scenarios: Sequence[SuiteScenario],
    *,
    expression: str = "",
    tags: Collection[str] = (),
    names: Collection[str] | None = None,
    shard: Shard | None = None,
) -> tuple[SuiteScenario, ...]:
    """Chooses scenarios; each argument restricts further.

    Args:
        scenarios: Those of the suite.
        expression: Words that names or tags contain, joined by ``and``, ``or``, ``not`` and
            parentheses; "": all.
        tags: Scenarios with any of these tags; empty: all.
        names: Scenarios of these names; ``None``: all.
        shard: A part of what remains, so that the parts are of about the same size.

    Raises:
        ConfigurationError: The expression cannot be read, no scenario has one of the tags, or
            nothing remains.
    """
    meets = read_expression(expression) if expression else None
    known = {tag for one in scenarios for tag in one.tags}
    for tag in tags:
        if tag not in known:
            raise ConfigurationError(
                f"--tag {tag}: no scenario has it; tags: {', '.join(sorted(known)) or 'none'}"
            )
    chosen = [
        one
        for one in scenarios
        if (meets is None or meets(one))
        and (not tags or not set(tags).isdisjoint(one.tags))
        and (names is None or one.name in names)
    ]
    if not chosen:
        raise ConfigurationError(
            f"none of the {len(scenarios)} scenarios is chosen; `drivora suite list` shows their "
            "names and tags"
        )
    if shard is None:
        return tuple(chosen)
    part = tuple(chosen[shard.number - 1 :: shard.of])
    if not part:
        raise ConfigurationError(
            f"--shard {shard}: only {len(chosen)} scenarios are chosen; use at most as many shards"
        )
    return part


def read_expression(text: str) -> Condition:
    """Reads a condition on the name and the tags of a scenario.

    Raises:
        ConfigurationError: It cannot be read.
    """
    reader = _Reader(text)
    condition = reader.alternatives()
    if reader.next is not None:
        raise reader.error(f"found {reader.next!r}, where `and`, `or` or the end is expected")
    return condition


class _Reader:
    """Reads an expression from left to right; ``not`` binds closest, then ``and``."""

    def __init__(self, text: str) -> None:
        self._text = text
        self._tokens = [match[1] for match in _TOKEN.finditer(text)]
        self._place = 0
        self._depth = 0

    @property
    def next(self) -> str | None:
        """The next word; ``None`` at the end."""
        return self._tokens[self._place] if self._place < len(self._tokens) else None

    def error(self, message: str) -> ConfigurationError:
        """Returns an error about the expression."""
        return ConfigurationError(f"--select {self._text[:200]!r}: {message}")

    def alternatives(self) -> Condition:
        """Reads conditions joined by ``or``."""
        parts = [self._conjunction()]
        while self._takes("or"):
            parts.append(self._conjunction())
        return lambda one: any(part(one) for part in parts)

    def _conjunction(self) -> Condition:
        parts = [self._negation()]
        while self._takes("and"):
            parts.append(self._negation())
        return lambda one: all(part(one) for part in parts)

    def _negation(self) -> Condition:
        negated = False
        while self._takes("not"):
            negated = not negated
        inner = self._word()
        return (lambda one: not inner(one)) if negated else inner

    def _word(self) -> Condition:
        if self._takes("("):
            self._depth += 1
            if self._depth > _DEEPEST:
                raise self.error(f"found more than {_DEEPEST} parentheses around each other")
            inner = self.alternatives()
            self._depth -= 1
            if not self._takes(")"):
                raise self.error("found no closing parenthesis")
            return inner
        word = self.next
        if word is None or word in (")", "and", "or"):
            raise self.error(f"found {word or 'the end'!r}, where a word is expected")
        self._place += 1
        return lambda one: word in one.name or any(word in tag for tag in one.tags)

    def _takes(self, token: str) -> bool:
        if self.next != token:
            return False
        self._place += 1
        return True
