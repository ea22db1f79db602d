"""Sums of signals with units: the two sides of comparisons, and the bounds of intervals."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from drivora_service.oracles.laws.formula import Comparison
from drivora_service.oracles.laws.law_signals import BY_NAME
from drivora_service.oracles.laws.law_tokens import FormulaError
from drivora_service.oracles.laws.units import ONE, Unit


@dataclass(frozen=True, slots=True, kw_only=True)
class Value:
    """A sum of signals and a constant.

    Attributes:
        terms: Factors by signal, none of them 0.
        constant: The rest.
        unit: ``None`` for bare numbers, which take the unit of what they are compared with or added
            to.
        offset: Character of the formula at which it begins.
        text: As written.
    """

    terms: dict[str, float]
    constant: float
    unit: Unit | None
    offset: int
    text: str

    @property
    def is_constant(self) -> bool:
        """Whether it has no signal."""
        return not self.terms

    def describe(self) -> str:
        """Returns the value for messages."""
        return f"`{self.text}`" + ("" if self.unit is None else f" in {self.unit}")


def add_values(left: Value, right: Value, sign: float, text: str, offset: int) -> Value:
    """Returns a sum (``sign`` 1) or difference (-1).

    Raises:
        FormulaError: The units differ.
    """
    unit = _common_unit(left, right, "added" if sign > 0 else "subtracted", offset)
    terms = dict(left.terms)
    for name, factor in right.terms.items():
        terms[name] = terms.get(name, 0.0) + sign * factor
    return Value(
        terms={name: factor for name, factor in terms.items() if factor},
        constant=left.constant + sign * right.constant,
        unit=unit,
        offset=left.offset,
        text=text,
    )


def multiply_values(left: Value, right: Value, text: str, offset: int) -> Value:
    """Returns a product.

    Raises:
        FormulaError: Both have signals.
    """
    if not left.is_constant and not right.is_constant:
        raise FormulaError(
            f"found the product of the signals in `{left.text}` and `{right.text}`; one of the two "
            "must be a number or a parameter",
            offset,
        )
    by, other = (left, right) if left.is_constant else (right, left)
    return _scale(other, by.constant, _combine_units(left, right, Unit.__mul__), left.offset, text)


def divide_values(left: Value, right: Value, text: str, offset: int) -> Value:
    """Returns a quotient.

    Raises:
        FormulaError: The divisor has a signal, or is 0.
    """
    if not right.is_constant or not right.constant:
        found = "0" if right.is_constant else f"`{right.text}`"
        raise FormulaError(
            f"found {found} as a divisor; allowed are numbers and parameters other than 0", offset
        )
    return _scale(
        left, 1.0 / right.constant, _combine_units(left, right, Unit.__truediv__), left.offset, text
    )


def negate_value(value: Value, text: str, offset: int) -> Value:
    """Returns the value with the other sign."""
    return _scale(value, -1.0, value.unit, offset, text)


def compare_values(left: Value, operator: str, right: Value, offset: int) -> Comparison:
    """Returns the comparison of two values, scaled to the common range.

    Raises:
        FormulaError: The units differ, or no signal is compared.
    """
    _common_unit(left, right, "compared", offset)
    greater, less = (left, right) if operator in (">", ">=") else (right, left)
    difference = add_values(greater, less, -1.0, "", offset)
    if difference.is_constant:
        raise FormulaError(
            f"`{left.text} {operator} {right.text}` names no signal whose value matters", offset
        )
    return Comparison(
        left=left.text,
        operator=operator,
        right=right.text,
        terms=tuple(sorted(difference.terms.items())),
        constant=difference.constant,
        scale=max(abs(factor) * BY_NAME[name].scale for name, factor in difference.terms.items()),
    )


def _scale(value: Value, factor: float, unit: Unit | None, offset: int, text: str) -> Value:
    return Value(
        terms={name: own * factor for name, own in value.terms.items() if own * factor},
        constant=value.constant * factor,
        unit=unit,
        offset=offset,
        text=text,
    )


def _common_unit(left: Value, right: Value, done: str, offset: int) -> Unit | None:
    if left.unit is None or right.unit is None or left.unit == right.unit:
        return right.unit if left.unit is None else left.unit
    raise FormulaError(
        f"{left.describe()} and {right.describe()} cannot be {done}: the units differ", offset
    )


def _combine_units(
    left: Value, right: Value, operation: Callable[[Unit, Unit], Unit]
) -> Unit | None:
    if left.unit is None and right.unit is None:
        return None
    return operation(left.unit or ONE, right.unit or ONE)
