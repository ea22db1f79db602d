"""Screening: each objective is modelled over the features on which it seems to depend.

A scenario has about as many features as a campaign has simulations, and an objective depends on few
of them: the distance to a walker hardly on the model of a vehicle. Over all features every
surrogate would predict no better than the mean.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from drivora_service.geometry.arrays import FloatArray, IntArray
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


def screened(fit: Fit) -> Callable[[FloatArray, FloatArray], Screened]:
    """Returns a fit function that uses the relevant features of each objective."""

    def fit_screened(features: FloatArray, objectives: FloatArray) -> Screened:
        parts = []
        for column in objectives.T:
            chosen = relevant_features(features, column)
            parts.append((chosen, fit(features[:, chosen], column[:, None])))
        return Screened(parts=tuple(parts))

    return fit_screened


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
    centred = features - features.mean(axis=0)
    squared = centred * centred
    strength = np.maximum(
        _correlations(centred, objective),
        _correlations(squared - squared.mean(axis=0), objective),
    )
    count = int(np.sum(strength * np.sqrt(len(features)) > SIGNIFICANCE))
    chosen: IntArray = np.argsort(-strength, kind="stable")[: max(count, AT_LEAST)]
    return np.sort(chosen)


def _correlations(centred: FloatArray, objective: FloatArray) -> FloatArray:
    """Returns the absolute correlation (e,) of centred features (n, e); 0 for constant ones."""
    other = objective - objective.mean()
    spread = np.sqrt(np.einsum("ij,ij->j", centred, centred) * (other @ other))
    shares: FloatArray = np.abs(other @ centred) / np.where(spread > 1e-9, spread, np.inf)
    return shares
