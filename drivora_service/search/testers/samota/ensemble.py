"""The ensemble of surrogates: a weighted mean, and their disagreement as uncertainty."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.search.testers.samota.surrogates import Fit, Surrogate


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Prediction:
    """The prediction of surrogates for q candidates.

    Attributes:
        objectives: (q, m) expected values.
        uncertainty: (q, m) largest disagreement between two surrogates, not negative.
    """

    objectives: FloatArray
    uncertainty: FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Ensemble:
    """Several surrogates of m objectives.

    Attributes:
        surrogates: s models of the scaled objectives.
        weights: (s, m) shares of the models in each objective's mean; 1 in all.
        mean: (m,) means of the training set.
        deviation: (m,) standard deviations of the training set.
    """

    surrogates: tuple[Surrogate, ...]
    weights: FloatArray
    mean: FloatArray
    deviation: FloatArray

    def predict(self, features: FloatArray) -> Prediction:
        """Predicts the objectives of candidates with features (q, e)."""
        # The weights are for the mean only. The uncertainty is the dissent of any two surrogates,
        # which a simulation of the candidate settles.
        said = np.stack([surrogate.predict(features) for surrogate in self.surrogates])
        expected = np.einsum("sm,sqm->qm", self.weights, said)
        return Prediction(
            objectives=self.mean + self.deviation * expected,
            uncertainty=self.deviation * np.ptp(said, axis=0),
        )


def fit_ensemble(
    features: FloatArray,
    objectives: FloatArray,
    fits: Sequence[Fit],
    random: np.random.Generator,
    *,
    folds: int,
) -> Ensemble:
    """Trains surrogates and weights them by their errors of validation.

    Args:
        features: (n, e), n at least 2 times ``folds``.
        objectives: (n, m).
        fits: Fit function of each kind of surrogate.
        random: Generator for the folds of the validation.
        folds: Number of parts of the training set; each is predicted by models of the others.
    """
    # Scaled, as the ridges and noises of the surrogates are shares of a variance of 1.
    mean, deviation = objectives.mean(axis=0), objectives.std(axis=0)
    deviation = np.where(deviation > 1e-12, deviation, 1.0)
    scaled = (objectives - mean) / deviation
    # The models of the folds only weight; those that predict are trained with all points. A fold
    # has nearly that mean and deviation, and the same data for all models that it compares.
    return Ensemble(
        surrogates=tuple(fit(features, scaled) for fit in fits),
        weights=weights(validation_errors(features, scaled, fits, random, folds=folds)),
        mean=mean,
        deviation=deviation,
    )


def validation_errors(
    features: FloatArray,
    objectives: FloatArray,
    fits: Sequence[Fit],
    random: np.random.Generator,
    *,
    folds: int,
) -> FloatArray:
    """Returns the root mean squared errors (s, m) of cross-validation."""
    # Errors on points that a model has not seen: at its own points, a radial basis function has
    # nearly none. The parts differ by one point at most in size, and are drawn for each training.
    part = random.permutation(len(features)) % folds
    squared = np.zeros((len(fits), objectives.shape[1]))
    for held in range(folds):
        is_test = part == held
        known, wanted = features[~is_test], objectives[~is_test]
        asked, answers = features[is_test], objectives[is_test]
        for index, fit in enumerate(fits):
            error = fit(known, wanted).predict(asked)
            error -= answers
            squared[index] += np.sum(error * error, axis=0)
    return np.sqrt(squared / len(features))


def weights(errors: FloatArray) -> FloatArray:
    """Returns the weight of each of s surrogates in the mean of each objective, by their errors.

    Source: Goel et al., "Ensemble of surrogates" (2007), their first scheme: the share of a
    surrogate is the sum of the errors of the others over s - 1 times the sum of all.

    Args:
        errors: (s, m) errors of validation, not negative.
    """
    # However small its error, a surrogate has at most 1 / (s - 1) of the mean: of three, the one
    # that was best in the validation decides half at most.
    count = len(errors)
    total = errors.sum(axis=0)
    if count == 1:
        return np.ones_like(errors)
    safe = np.where(total > 0.0, total, 1.0)
    shares: FloatArray = np.where(total > 0.0, (total - errors) / ((count - 1) * safe), 1.0 / count)
    return shares
