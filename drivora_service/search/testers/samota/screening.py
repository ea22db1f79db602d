"""Screening: each objective is modelled over the features on which it seems to depend.

A scenario has about as many features as a campaign has simulations, and an objective depends on few
of them: the distance to a walker hardly on the model of a vehicle. Over all features every
surrogate would predict no better than the mean.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray, IntArray
from drivora_service.search.testers.samota.surrogates import Fit, Surrogate

SIGNIFICANCE = 3.0
"""Standard errors by which a correlation must differ from 0."""

AT_LEAST = 4
"""Number of features that are always kept."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Screened:
    """One surrogate for each objective, over its own features.

    Attributes:
        parts: For each objective, the features and a surrogate of that objective alone.
    """

    parts: tuple[tuple[IntArray, Surrogate], ...]

    def predict(self, features: FloatArray) -> FloatArray:
        """Returns the objectives (q, m)."""
        said = [surrogate.predict(features[:, chosen]) for chosen, surrogate in self.parts]
        return np.concatenate(said, axis=1)


def add_screening(*fits: Fit) -> tuple[Fit, ...]:
    """Returns fit functions that use the relevant features of each objective.

    They are meant to be called one after another with the same arrays, which are screened once.
    """
    screening = _Screening()
    return tuple(partial(screening.fit, fit) for fit in fits)


class _Screening:
    """The relevant features of the arrays that were screened last."""

    def __init__(self) -> None:
        self._arrays: tuple[FloatArray, FloatArray] | None = None
        self._parts: list[tuple[IntArray, FloatArray, FloatArray]] = []

    def fit(self, fit: Fit, features: FloatArray, objectives: FloatArray) -> Screened:
        """Fits a surrogate of each objective over its own features."""
        arrays = self._arrays
        if arrays is None or arrays[0] is not features or arrays[1] is not objectives:
            self._arrays = features, objectives
            self._parts = [
                (chosen, features[:, chosen], column[:, None])
                for chosen, column in zip(
                    _relevant(features, objectives), objectives.T, strict=True
                )
            ]
        return Screened(
            parts=tuple((chosen, fit(known, column)) for chosen, known, column in self._parts)
        )


def relevant_features(features: FloatArray, objective: FloatArray) -> IntArray:
    """Returns the features that correlate with an objective, directly or by distance to the mean.

    Sure independence screening (Fan and Lv, 2008), with squares: an objective is often best in the
    middle of a magnitude.

    Args:
        features: (n, e).
        objective: (n,).

    Returns:
        Indices in ascending order.
    """
    return _relevant(features, objective[:, None])[0]


def _relevant(features: FloatArray, objectives: FloatArray) -> list[IntArray]:
    """Returns the relevant features of each of the objectives (n, m)."""
    centred = features - features.mean(axis=0)
    squared = centred * centred
    squared -= squared.mean(axis=0)
    variants = [(table, np.einsum("ij,ij->j", table, table)) for table in (centred, squared)]
    found = []
    for column in objectives.T:
        other = column - column.mean()
        direct, distant = (_correlations(table, sums, other) for table, sums in variants)
        strength = np.maximum(direct, distant)
        count = int(np.sum(strength * np.sqrt(len(features)) > SIGNIFICANCE))
        chosen = np.argsort(-strength, kind="stable")[: max(count, AT_LEAST)]
        found.append(np.sort(chosen))
    return found


def _correlations(centred: FloatArray, sums: FloatArray, other: FloatArray) -> FloatArray:
    """Returns the absolute correlations (e,) with an objective; 0 for constant features.

    Args:
        centred: (n, e) features of mean 0.
        sums: (e,) sums of their squares.
        other: (n,) objective of mean 0.
    """
    spread = np.sqrt(sums * (other @ other))
    shares: FloatArray = np.abs(other @ centred) / np.where(spread > 1e-9, spread, np.inf)
    return shares
