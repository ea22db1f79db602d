"""A measured quantity: a value for each ego, and one for the run."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from statistics import fmean


class Combine(Enum):
    """How the values of the egos are aggregated; egos without a value are left out."""

    MEAN = "mean"
    LEAST = "least"
    MOST = "most"


@dataclass(frozen=True, slots=True, kw_only=True)
class Measured:
    """A quantity of a run.

    Attributes:
        name: Name, with its unit as a suffix unless it is a share, a percentage or a score.
        values: A value for each ego; ``None`` if not measurable.
        combine: How they are aggregated to the value of the run.
    """

    name: str
    values: tuple[float | None, ...]
    combine: Combine

    @property
    def total(self) -> float | None:
        """The value of the run; ``None`` if no ego has one."""
        return combine_values(self.values, self.combine)


def combine_values(values: Sequence[float | None], combine: Combine) -> float | None:
    """Aggregates the values of several egos."""
    known = [value for value in values if value is not None and math.isfinite(value)]
    if not known:
        return None
    if combine is Combine.MEAN:
        return fmean(known)
    return min(known) if combine is Combine.LEAST else max(known)
