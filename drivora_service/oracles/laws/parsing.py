"""Reading a formula: its grammar, and the checks of names, units and intervals.

Operators from the weakest to the strongest: ``->``, ``or``, ``and``, ``until[a:b]``, comparisons,
``+ -``, ``* /``, then ``not``, ``-`` and the temporal operators, which take what follows directly.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from drivora_service.known_names import similar_names
from drivora_service.oracles.laws.formula import (
    And,
    Flag,
    Formula,
    Implies,
    Interval,
    Not,
    Or,
    Temporal,
    Until,
    Window,
)
from drivora_service.oracles.laws.law_signals import BY_NAME
from drivora_service.oracles.laws.law_tokens import FormulaError, Token, tokenize
from drivora_service.oracles.laws.units import SECOND, Unit
from drivora_service.oracles.laws.values import (
    Value,
    add_values,
    compare_values,
    divide_values,
    multiply_values,
    negate_value,
)

MAX_DEPTH = 40
"""Greatest number of operators and brackets inside one another."""

LONGEST_WINDOW = 60.0
"""Greatest end of an interval, seconds."""

LONGEST_UNTIL = 10.0
"""The same of `until`, which takes longer to compute."""

_COMPARISONS = ("<", "<=", ">", ">=")
_WINDOWS = tuple(window.value for window in Window)


@dataclass(frozen=True, slots=True, kw_only=True)
class Quantity:
    """The value of a parameter with its unit."""

    value: float
    unit: Unit


def read_law(text: str, parameters: Mapping[str, Quantity]) -> tuple[Formula, frozenset[str]]:
    """Reads the formula of a law.

    Args:
        text: ``always (FORMULA)``.
        parameters: The law's parameters.

    Returns:
        The formula that must hold in every row, and the names of the parameters in it.

    Raises:
        FormulaError: It cannot be used; says what was found, and what is allowed.
    """
    parser = _Parser(text, parameters)
    formula = parser.law()
    return formula, frozenset(parser.used)


class _Parser:
    def __init__(self, text: str, parameters: Mapping[str, Quantity]) -> None:
        self._text, self._parameters = text, parameters
        self._tokens = tokenize(text)
        self._next = 0
        self._depth = 0
        self.used: set[str] = set()

    def law(self) -> Formula:
        first = self._take()
        if first.text != Window.ALWAYS:
            raise FormulaError(
                f"found {first}; a law is `always (…)`: it must hold at every moment", first.offset
            )
        if self._here.text == "[":
            raise FormulaError(
                "found an interval; the `always` that begins a law has none: it must hold in the "
                "whole run",
                self._here.offset,
            )
        formula = self._formula(self._inside(self._unary))
        if self._here.kind != "end":
            raise FormulaError(
                f"found {self._here}; expected an operator, or the end of the formula. What holds "
                "at every moment stands in the brackets of `always (…)`",
                self._here.offset,
            )
        return formula

    @property
    def _here(self) -> Token:
        return self._tokens[self._next]

    def _take(self) -> Token:
        token = self._here
        self._next = min(self._next + 1, len(self._tokens) - 1)
        return token

    def _accept(self, *texts: str) -> Token | None:
        """Takes the next token if it is one of some signs."""
        return self._take() if self._here.kind == "sign" and self._here.text in texts else None

    def _expect(self, text: str, why: str) -> None:
        if self._accept(text) is None:
            raise FormulaError(f"found {self._here}; expected {text!r} {why}", self._here.offset)

    def _inside(self, part: Callable[[], Part]) -> Part:
        self._depth += 1
        if self._depth > MAX_DEPTH:
            raise FormulaError(
                f"more than {MAX_DEPTH} operators and brackets inside one another",
                self._here.offset,
            )
        found = part()
        self._depth -= 1
        return found

    def _implication(self) -> Part:
        left = self._any_of()
        if self._accept("->") is None:
            return left
        condition = self._formula(left)
        return Implies(
            condition=condition, consequence=self._formula(self._inside(self._implication))
        )

    def _any_of(self) -> Part:
        first = self._all_of()
        parts = [first]
        while self._accept("or") is not None:
            parts.append(self._all_of())
        return first if len(parts) == 1 else Or(parts=tuple(map(self._formula, parts)))

    def _all_of(self) -> Part:
        first = self._until()
        parts = [first]
        while self._accept("and") is not None:
            parts.append(self._until())
        return first if len(parts) == 1 else And(parts=tuple(map(self._formula, parts)))

    def _until(self) -> Part:
        left = self._comparison()
        word = self._accept("until")
        if word is None:
            return left
        interval = self._interval(word)
        right = self._comparison()
        return Until(left=self._formula(left), right=self._formula(right), interval=interval)

    def _comparison(self) -> Part:
        left = self._sum()
        sign = self._accept(*_COMPARISONS)
        if sign is None:
            return left
        right = self._sum()
        made = compare_values(self._value(left), sign.text, self._value(right), sign.offset)
        if self._here.text in _COMPARISONS:
            raise FormulaError(
                f"found a second comparison, {self._here}; join two by `and`", self._here.offset
            )
        return made

    def _sum(self) -> Part:
        begin = self._here.offset
        left = self._product()
        while (sign := self._accept("+", "-")) is not None:
            right = self._product()
            factor = 1.0 if sign.text == "+" else -1.0
            left = add_values(
                self._value(left), self._value(right), factor, self._since(begin), sign.offset
            )
        return left

    def _product(self) -> Part:
        begin = self._here.offset
        left = self._unary()
        while (sign := self._accept("*", "/")) is not None:
            right = self._unary()
            join = multiply_values if sign.text == "*" else divide_values
            left = join(self._value(left), self._value(right), self._since(begin), sign.offset)
        return left

    def _unary(self) -> Part:
        token = self._take()
        if token.kind == "number":
            return self._number(token)
        if token.kind == "name":
            return self._resolve_name(token)
        if token.text == "(":
            found = self._inside(self._implication)
            self._expect(")", f"for the bracket at character {token.offset + 1}")
            if isinstance(found, Value):
                return negate_value(
                    negate_value(found, "", 0), self._since(token.offset), token.offset
                )
            return found
        if token.text == "not":
            return Not(inner=self._formula(self._inside(self._unary)))
        if token.text == "-":
            value = self._value(self._inside(self._unary))
            return negate_value(value, self._since(token.offset), token.offset)
        if token.text in _WINDOWS:
            interval = self._interval(token)
            inner = self._formula(self._inside(self._unary))
            return Temporal(window=Window(token.text), interval=interval, inner=inner)
        raise FormulaError(
            f"found {token}; expected a signal, a parameter, a number, a bracket, `not` or a "
            f"temporal operator ({', '.join(_WINDOWS)})",
            token.offset,
        )

    def _number(self, token: Token) -> Value:
        number = float(token.text)
        if number > 1e9:
            raise FormulaError(f"found {token}; at most 1e9 is allowed", token.offset)
        return Value(terms={}, constant=number, unit=None, offset=token.offset, text=token.text)

    def _resolve_name(self, token: Token) -> Part:
        if token.text in self._parameters:
            self.used.add(token.text)
            quantity = self._parameters[token.text]
            return Value(
                terms={},
                constant=quantity.value,
                unit=quantity.unit,
                offset=token.offset,
                text=token.text,
            )
        signal = BY_NAME.get(token.text)
        if signal is None:
            raise FormulaError(self._unknown(token.text), token.offset)
        if signal.unit is None:
            return Flag(signal=signal.name)
        return Value(
            terms={signal.name: 1.0},
            constant=0.0,
            unit=signal.unit,
            offset=token.offset,
            text=token.text,
        )

    def _unknown(self, name: str) -> str:
        known = (*self._parameters, *BY_NAME)
        close = similar_names(name, known)
        meant = f"; did you mean {close[0]!r}?" if close else ""
        own = ", ".join(self._parameters) or "none"
        return (
            f"unknown name {name[:60]!r}{meant} Known signals: {', '.join(BY_NAME)}; parameters of "
            f"this law: {own}"
        ).replace("' Known", "'. Known")

    def _interval(self, word: Token) -> Interval:
        if self._accept("[") is None:
            raise FormulaError(
                f"found {self._here} after `{word.text}`; expected its interval in seconds, as "
                f"`{word.text}[0:3]`: only the `always` that begins a law is without bounds",
                self._here.offset,
            )
        place = self._here.offset
        start = self._bound()
        self._expect(":", "between the two bounds of an interval")
        end = self._bound()
        self._expect("]", "after the two bounds of an interval")
        if not 0.0 <= start <= end:
            raise FormulaError(
                f"the interval [{start:g}:{end:g}] is empty or negative; its bounds are 0 or more, "
                "the smaller first",
                place,
            )
        most = LONGEST_UNTIL if word.text == "until" else LONGEST_WINDOW
        if end > most:
            raise FormulaError(
                f"the interval ends after {end:g} s; at most {most:g} s are allowed",
                place,
            )
        return Interval(start=start, end=end)

    def _bound(self) -> float:
        value = self._value(self._sum())
        if not value.is_constant:
            raise FormulaError(
                f"found `{value.text}`; the bounds of an interval are numbers or parameters in s",
                value.offset,
            )
        if value.unit not in (None, SECOND):
            raise FormulaError(
                f"found {value.describe()}; the bounds of an interval are in s", value.offset
            )
        return value.constant

    def _formula(self, part: Part) -> Formula:
        if isinstance(part, Value):
            raise FormulaError(
                f"found the value {part.describe()} where a condition is needed; compare it by "
                "<=, <, >= or >",
                part.offset,
            )
        return part

    def _value(self, part: Part) -> Value:
        if isinstance(part, Value):
            return part
        here = self._tokens[max(self._next - 1, 0)].offset
        raise FormulaError(
            f"found the condition `{part}` where a measured value is needed; a flag is used by its "
            "name, without a comparison",
            here,
        )

    def _since(self, begin: int) -> str:
        """Returns the text from a character to the last token that was taken, in one line."""
        return " ".join(self._text[begin : self._tokens[self._next - 1].stop].split())


Part = Formula | Value
"""A condition or a value: which one, only its operator tells."""
