"""A signal of formulas: what it is, and how its values come about."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.observations.run_view import EgoView
from drivora_service.oracles.laws.units import Unit


@dataclass(frozen=True, slots=True, kw_only=True)
class Signal:
    """A quantity of an ego at every row.

    Attributes:
        name: Name in formulas.
        unit: ``None`` for a flag, which is true or false.
        scale: Difference from a threshold, in that unit, at which the robustness is 1; 1 for flags.
        meaning: One sentence.
        absent: Value where there is nothing to measure; NaN if there always is.
        values: Returns the (n,) values of an ego; NaN where there is nothing to measure.
    """

    name: str
    unit: Unit | None
    scale: float
    meaning: str
    absent: float
    values: Callable[[EgoView], FloatArray]

    @property
    def is_flag(self) -> bool:
        """Whether it is true or false."""
        return self.unit is None


def flag(name: str, meaning: str, values: Callable[[EgoView], FloatArray]) -> Signal:
    """Returns a signal that is true or false."""
    return Signal(name=name, unit=None, scale=1.0, meaning=meaning, absent=0.0, values=values)


def measure(
    name: str,
    unit: Unit,
    scale: float,
    meaning: str,
    values: Callable[[EgoView], FloatArray],
    absent: float = np.nan,
) -> Signal:
    """Returns a signal with a unit."""
    return Signal(name=name, unit=unit, scale=scale, meaning=meaning, absent=absent, values=values)
