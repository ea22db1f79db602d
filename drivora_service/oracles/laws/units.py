"""Units of signals, parameters and numbers in formulas, as powers of metre, second and radian."""

from __future__ import annotations

import re
from dataclasses import dataclass

_SYMBOLS = ("m", "s", "rad")
_PART = re.compile(r"(m|s|rad|1)(?:\^?(-?[0-9])|([²³]))?")
_RAISED = {"²": 2, "³": 3}


@dataclass(frozen=True, slots=True, kw_only=True)
class Unit:
    """A unit.

    Attributes:
        powers: Exponents of metre, second and radian.
    """

    powers: tuple[int, int, int]

    def __mul__(self, other: Unit) -> Unit:
        """Returns the unit of a product."""
        a, b, c = (mine + its for mine, its in zip(self.powers, other.powers, strict=True))
        return Unit(powers=(a, b, c))

    def __truediv__(self, other: Unit) -> Unit:
        """Returns the unit of a quotient."""
        a, b, c = (mine - its for mine, its in zip(self.powers, other.powers, strict=True))
        return Unit(powers=(a, b, c))

    def __str__(self) -> str:
        """Returns the unit as text: ``m/s²``; ``1`` without a dimension."""
        above = [_power(name, n) for name, n in zip(_SYMBOLS, self.powers, strict=True) if n > 0]
        below = [_power(name, -n) for name, n in zip(_SYMBOLS, self.powers, strict=True) if n < 0]
        return "/".join(["·".join(above) or "1", *below])


ONE = Unit(powers=(0, 0, 0))
"""No dimension: shares and counts."""
METRE = Unit(powers=(1, 0, 0))
SECOND = Unit(powers=(0, 1, 0))
RADIAN = Unit(powers=(0, 0, 1))
SPEED = METRE / SECOND
ACCELERATION = SPEED / SECOND


def read_unit(text: str) -> Unit | None:
    """Reads a unit such as ``m/s²`` or ``m/s^2``; ``None`` if it is not one of m, s and rad."""
    unit = ONE
    for place, part in enumerate(text.replace(" ", "").split("/")):
        for factor in part.replace("*", "·").split("·"):
            match = _PART.fullmatch(factor)
            if match is None:
                return None
            power = int(match[2]) if match[2] else _RAISED.get(match[3] or "", 1)
            if match[1] == "1":
                continue
            powers = [power if name == match[1] else 0 for name in _SYMBOLS]
            own = Unit(powers=(powers[0], powers[1], powers[2]))
            unit = unit / own if place else unit * own
    return unit


def _power(name: str, exponent: int) -> str:
    return name + {1: "", 2: "²", 3: "³"}.get(exponent, f"^{exponent}")
