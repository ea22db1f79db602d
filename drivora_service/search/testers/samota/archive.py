"""The simulated candidates, and the objectives that they cover."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from drivora_service.geometry.array_shapes import BoolArray, FloatArray, IntArray
from drivora_service.search.aims import Aim
from drivora_service.search.testers.samota.encoding import Encoding

NOT_MEASURABLE = 1.0
"""Value of an objective that a run has no value for: the worst of 0..1."""


class Database:
    """All judged candidates with their objectives.

    Attributes:
        names: Names of the m objectives; empty before the first candidate.
        numbers: Numbers of the evaluations.
    """

    def __init__(self, encoding: Encoding, aims: Sequence[Aim] = ()) -> None:
        """Creates an empty database.

        Args:
            encoding: Encodes candidates as features.
            aims: Objectives that the campaign chose; none: all that are measured.
        """
        self._encoding = encoding
        self._aims = {aim.name: aim for aim in aims}
        self._values: list[FloatArray] = []
        self._features: list[FloatArray] = []
        self._objectives: list[FloatArray] = []
        self._tables: tuple[FloatArray, FloatArray, FloatArray] | None = None
        self._known: set[bytes] = set()
        self.names: tuple[str, ...] = ()
        self.numbers: list[int] = []

    def __len__(self) -> int:
        """Returns the number n of candidates."""
        return len(self.numbers)

    def add(self, number: int, values: FloatArray, objectives: Mapping[str, float | None]) -> None:
        """Adds a judged candidate."""
        self.names = self.names or tuple(self._aims or objectives)
        row = [self._share(name, objectives[name]) for name in self.names]
        self.numbers.append(number)
        self._values.append(values)
        self._features.append(self._encoding.encode(values[None])[0])
        self._objectives.append(np.array([NOT_MEASURABLE if v is None else v for v in row]))
        self._known.add(self._features[-1].tobytes())
        self._tables = None

    def _share(self, name: str, value: float | None) -> float | None:
        """Returns a chosen objective on the scale of the feedback's own, 0 at its target."""
        aim = self._aims.get(name)
        return value if aim is None or value is None else aim.share(value)

    def note(self, values: FloatArray) -> None:
        """Records a candidate as proposed, so that it is not proposed again."""
        self._known.add(self._encoding.encode(values[None])[0].tobytes())

    def knows(self, features: FloatArray) -> bool:
        """Returns whether a candidate with these features (e,) was proposed or simulated before."""
        return features.tobytes() in self._known

    @property
    def values(self) -> FloatArray:
        """(n, d) genes."""
        return self._stack_tables()[0]

    @property
    def features(self) -> FloatArray:
        """(n, e) features."""
        return self._stack_tables()[1]

    @property
    def objectives(self) -> FloatArray:
        """(n, m) objectives."""
        return self._stack_tables()[2]

    def _stack_tables(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        if self._tables is None:
            values, features, objectives = self._values, self._features, self._objectives
            self._tables = np.stack(values), np.stack(features), np.stack(objectives)
        return self._tables

    def nearest(self, objectives: IntArray, count: int) -> IntArray:
        """Returns the rows of up to ``count`` candidates nearest to a violation, each row once.

        The objectives take turns: first the best of each, then the second of each, and so on.
        """
        ranked = np.argsort(self.objectives[:, objectives], axis=0, kind="stable")
        rows, first = np.unique(ranked, return_index=True)
        found: IntArray = rows[np.argsort(first, kind="stable")][:count]
        return found

    def training_rows(self, objectives: IntArray, limit: int) -> IntArray:
        """Returns the rows to train surrogates with, in ascending order.

        Up to the limit: all. Beyond it: half of the limit are those nearest to a violation, where
        the surrogates must be accurate; the rest is spread evenly over all others in the order of
        their evaluation, which keeps a part of the initial sample of the whole space.
        """
        n = len(self)
        if n <= limit:
            return np.arange(n)
        near = self.nearest(objectives, limit // 2)
        others = np.setdiff1d(np.arange(n), near)
        spread = np.linspace(0.0, len(others) - 1.0, limit - len(near)).round().astype(np.int64)
        return np.sort(np.concatenate((near, others[spread])))


class Archive:
    """The covered objectives, with the candidates that cover them.

    An objective is covered once a simulated candidate reaches its threshold. When no objective is
    left to search for, a new round begins, in which every objective must be covered again.

    Attributes:
        round: Number of the round, from 0.
    """

    def __init__(self, threshold: float, aims: Sequence[Aim] = ()) -> None:
        """Creates an empty archive.

        Args:
            threshold: Value at and below which an objective of the feedback is covered.
            aims: Objectives that the campaign chose, which have their own targets; none: all that
                are measured.
        """
        self._threshold = threshold
        self._aims = {aim.name: aim for aim in aims}
        self._best: dict[str, tuple[float, int]] = {}
        self._covered: set[str] = set()
        self.round = 0

    def update(self, number: int, objectives: Mapping[str, float | None]) -> None:
        """Takes an evaluation into account; an equal one does not replace an objective's best."""
        for name, value in objectives.items():
            if value is None or (self._aims and name not in self._aims):
                continue
            if name not in self._best or value < self._best[name][0]:
                self._best[name] = (value, number)
            if self._is_covered(name, value):
                self._covered.add(name)

    def _is_covered(self, name: str, value: float) -> bool:
        if name in self._aims:
            return self._aims[name].is_reached(value)
        return value <= self._threshold

    @property
    def covered(self) -> frozenset[str]:
        """Objectives covered in this round."""
        return frozenset(self._covered)

    def best(self, objective: str) -> tuple[float, int] | None:
        """Returns an objective's least value of all rounds and the number of its evaluation."""
        return self._best.get(objective)

    def is_uncovered(self, names: tuple[str, ...]) -> BoolArray:
        """Returns which of the objectives (m,) are not covered in this round."""
        return np.array([name not in self._covered for name in names], dtype=np.bool_)

    def begin_round(self) -> None:
        """Clears the covered objectives."""
        self._covered.clear()
        self.round += 1
