"""Formulas of signal temporal logic over the rows of an ego.

Times are seconds. A formula has a robustness at every row: positive where it holds, negative where
it does not, and the larger the further from the other; see ``robustness``.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import TypeAlias


class Window(StrEnum):
    """A temporal operator with one operand."""

    ALWAYS = "always"
    EVENTUALLY = "eventually"
    HISTORICALLY = "historically"
    ONCE = "once"

    @property
    def is_past(self) -> bool:
        """Whether it looks back."""
        return self in (Window.HISTORICALLY, Window.ONCE)

    @property
    def is_universal(self) -> bool:
        """Whether its operand must hold at every row of the window, rather than at one."""
        return self in (Window.ALWAYS, Window.HISTORICALLY)

    @property
    def dual(self) -> Window:
        """The operator that remains of its negation."""
        return _DUALS[self]


_DUALS = {
    Window.ALWAYS: Window.EVENTUALLY,
    Window.EVENTUALLY: Window.ALWAYS,
    Window.HISTORICALLY: Window.ONCE,
    Window.ONCE: Window.HISTORICALLY,
}
_FLIPPED = {"<": ">=", "<=": ">", ">": "<=", ">=": "<"}


@dataclass(frozen=True, slots=True, kw_only=True)
class Interval:
    """The rows that a temporal operator looks at, in seconds from the row; none is negative."""

    start: float
    end: float

    def __str__(self) -> str:
        """Returns the interval as it is written."""
        return f"[{self.start:g}:{self.end:g}]"


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """A comparison of two sums of signals.

    Attributes:
        left, operator, right: As written, for messages.
        terms: Signals with their factors; the comparison holds where their sum and the constant
            are positive.
        constant: In the unit of the comparison.
        scale: Sum at which the robustness is 1, in the same unit.
    """

    left: str
    operator: str
    right: str
    terms: tuple[tuple[str, float], ...]
    constant: float
    scale: float

    def __str__(self) -> str:
        """Returns the comparison as it is written."""
        return f"{self.left} {self.operator} {self.right}"

    def negate(self) -> Comparison:
        """Returns the comparison that holds where this one does not."""
        return Comparison(
            left=self.left,
            operator=_FLIPPED[self.operator],
            right=self.right,
            terms=tuple((name, -factor) for name, factor in self.terms),
            constant=-self.constant,
            scale=self.scale,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Flag:
    """A signal that is true or false."""

    signal: str
    holds: bool = True

    def __str__(self) -> str:
        """Returns the signal as it is written."""
        return self.signal if self.holds else f"not {self.signal}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Not:
    """Negation."""

    inner: Formula

    def __str__(self) -> str:
        """Returns the formula as it is written."""
        return f"not {_inside(self.inner)}"


@dataclass(frozen=True, slots=True, kw_only=True)
class And:
    """Conjunction of two formulas or more."""

    parts: tuple[Formula, ...]

    def __str__(self) -> str:
        """Returns the formula as it is written."""
        return " and ".join(_inside(part) for part in self.parts)


@dataclass(frozen=True, slots=True, kw_only=True)
class Or:
    """Disjunction of two formulas or more."""

    parts: tuple[Formula, ...]

    def __str__(self) -> str:
        """Returns the formula as it is written."""
        return " or ".join(_inside(part) for part in self.parts)


@dataclass(frozen=True, slots=True, kw_only=True)
class Implies:
    """Implication."""

    condition: Formula
    consequence: Formula

    def __str__(self) -> str:
        """Returns the formula as it is written."""
        return f"{_inside(self.condition)} -> {_inside(self.consequence)}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Temporal:
    """A formula that must hold at all rows of a window, or at one."""

    window: Window
    interval: Interval
    inner: Formula

    def __str__(self) -> str:
        """Returns the formula as it is written."""
        return f"{self.window}{self.interval} ({self.inner})"


@dataclass(frozen=True, slots=True, kw_only=True)
class Until:
    """``left until right``: right holds at a row of the interval, and left at all rows before it.

    Attributes:
        dual: Whether it is the negation of ``not left until not right`` instead ("release"), which
            cannot be written.
    """

    left: Formula
    right: Formula
    interval: Interval
    dual: bool = False

    def __str__(self) -> str:
        """Returns the formula as it is written."""
        word = "release" if self.dual else "until"
        return f"{_inside(self.left)} {word}{self.interval} {_inside(self.right)}"


Formula: TypeAlias = Comparison | Flag | Not | And | Or | Implies | Temporal | Until
"""A formula of signal temporal logic."""


def signals_of(formula: Formula) -> frozenset[str]:
    """Returns the names of the signals in a formula."""
    match formula:
        case Comparison():
            return frozenset(name for name, _ in formula.terms)
        case Flag():
            return frozenset((formula.signal,))
        case Not() | Temporal():
            return signals_of(formula.inner)
        case And() | Or():
            return frozenset().union(*(signals_of(part) for part in formula.parts))
        case Implies():
            return signals_of(formula.condition) | signals_of(formula.consequence)
        case Until():
            return signals_of(formula.left) | signals_of(formula.right)


def _inside(formula: Formula) -> str:
    """Returns the text of a part of a larger formula, in brackets where it needs them."""
    simple = isinstance(formula, Comparison | Flag | Not | Temporal)
    return str(formula) if simple else f"({formula})"
