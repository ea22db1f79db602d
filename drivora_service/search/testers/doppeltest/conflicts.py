"""Conflicts between the paths that egos choose from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from drivora_service.geometry.array_shapes import BoolArray, IntArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RouteConflicts:
    """Conflicts of p paths, numbered as in the egos' gene ``path``.

    Attributes:
        matrix: (p, p) symmetric; no path conflicts with itself.
    """

    matrix: BoolArray

    def between(self, path: float, others: Sequence[float]) -> bool:
        """Returns whether a path conflicts with any of ``others``."""
        return bool(self.matrix[int(path), [int(other) for other in others]].any())

    def among(self, paths: Sequence[float]) -> bool:
        """Returns whether any two of some paths conflict."""
        return any(self.matrix[int(one), int(other)] for one, other in combinations(paths, 2))

    def with_any(self, others: Sequence[float]) -> IntArray:
        """Returns the paths that conflict with any of ``others``."""
        return np.flatnonzero(self.matrix[:, [int(other) for other in others]].any(axis=1))

    def pairs(self) -> IntArray:
        """Returns the (n, 2) pairs of paths that conflict, each once."""
        return np.argwhere(np.triu(self.matrix))
