"""Surrogates: cheap models of the objectives.

All take features in 0..1 and model several objectives at once, independently. Objectives have
mean 0 and deviation 1 over the training set. The models are sums of kernels at the training points,
solved by SciPy and evaluated here: for the few candidates of a generation, the overhead of library
models is several times the arithmetic (decision 18).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray

SMOOTHING = 0.01
"""Ridge of the radial basis functions: similar scenarios may end differently."""

SHRINKAGE = 0.3
"""Ridge of the polynomial's coefficients, which may outnumber the training points."""

LENGTHS = (0.5, 1.0, 2.0, 4.0)
"""Candidate correlation lengths of Kriging, in deviations of the latent directions."""

NOISES = (0.01, 0.1, 0.5)
"""Candidate variances of what Kriging cannot explain; that of the process is 1."""


class Surrogate(Protocol):
    """A model of several objectives."""

    def predict(self, features: FloatArray) -> FloatArray:
        """Returns the objectives (q, m) of candidates with features (q, e)."""
        ...


Fit = Callable[[FloatArray, FloatArray], Surrogate]
"""Returns a model fitted to features (n, e) and objectives (n, m)."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RadialBasis:
    """Gaussian radial basis functions, one at each training point.

    Attributes:
        centres: (n, e) training points.
        width: Squared distance at which a function has fallen to 1/e.
        coefficients: (n, m).
    """

    centres: FloatArray
    width: float
    coefficients: FloatArray

    @staticmethod
    def fit(features: FloatArray, objectives: FloatArray) -> RadialBasis:
        """Fits the weights; the width is the median squared distance of the training points.

        So it scales with the number of features.
        """
        # The median heuristic: half of all pairs of training points have a value above 1/e,
        # whatever the number of features. A choice among widths would solve the system for each.
        squared = squared_distances(features, features)
        n = len(squared)
        # Without the diagonal, which is the last column of rows that are one longer.
        apart = squared.reshape(-1)[1:].reshape(n - 1, n + 1)[:, :-1]
        width = float(np.median(apart))
        # Otherwise most pairs are equal points, and any width does.
        width = width if width > 1e-9 else 1.0
        return RadialBasis(
            centres=features,
            width=width,
            coefficients=_solve_ridge(np.exp(-squared / width), SMOOTHING, objectives),
        )

    def predict(self, features: FloatArray) -> FloatArray:
        """Returns the predicted objectives (q, m) of features (q, e)."""
        values = squared_distances(features, self.centres)
        values /= -self.width
        predicted: FloatArray = np.exp(values, out=values) @ self.coefficients
        return predicted


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Polynomial:
    """A polynomial of degree 2 with all products, by ridge regression.

    In the dual form (Saunders, Gammerman, Vovk, "Ridge regression learning algorithm in dual
    variables", 1998), the cost of which does not depend on the number of coefficients, about e²/2.

    Attributes:
        points: (n, e) training points, in -1..1.
        coefficients: (n, m).
    """

    points: FloatArray
    coefficients: FloatArray

    @staticmethod
    def fit(features: FloatArray, objectives: FloatArray) -> Polynomial:
        """Returns the polynomial whose coefficients fit features (n, e) and objectives (n, m)."""
        points = _centre_features(features)
        return Polynomial(
            points=points,
            coefficients=_solve_ridge(_products(points, points), SHRINKAGE, objectives),
        )

    def predict(self, features: FloatArray) -> FloatArray:
        """Returns the predicted objectives (q, m) of features (q, e)."""
        predicted: FloatArray = (
            _products(_centre_features(features), self.points) @ self.coefficients
        )
        return predicted


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Latent:
    """One objective as a Gaussian process over a few latent directions of the features."""

    mean: FloatArray
    directions: FloatArray
    points: FloatArray
    length: float
    coefficients: FloatArray

    def predict(self, features: FloatArray) -> FloatArray:
        latent = (features - self.mean) @ self.directions
        values = squared_distances(latent, self.points)
        values *= -0.5 / self.length**2
        predicted: FloatArray = np.exp(values, out=values) @ self.coefficients
        return predicted


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Kriging:
    """Kriging over a few latent directions of the inputs, found for each objective.

    After Bouhlel et al., "Improving kriging surrogates of high-dimensional design models by partial
    least squares dimension reduction" (2016): with as many features as training points, a length
    for each of them can neither be learnt nor afforded.
    """

    latents: tuple[_Latent, ...]

    @staticmethod
    def fit(features: FloatArray, objectives: FloatArray, *, components: int) -> Kriging:
        """Fits every objective; length and noise are the most likely ones of a small grid."""
        # n centred points span n - 1 directions at most.
        count = min(components, features.shape[1], len(features) - 1)
        return Kriging(
            latents=tuple(_fit_latent(features, column, count) for column in objectives.T)
        )

    def predict(self, features: FloatArray) -> FloatArray:
        """Returns the predicted objectives (q, m) of features (q, e)."""
        return np.stack([latent.predict(features) for latent in self.latents], axis=1)


def _fit_latent(features: FloatArray, objective: FloatArray, components: int) -> _Latent:
    from scipy.linalg.lapack import dpotrf, dpotrs

    mean = features.mean(axis=0)
    rotations = latent_directions(features - mean, objective, components)
    latent = (features - mean) @ rotations
    # Scaled, so that one length serves all directions, and the grid of lengths any data.
    deviation = latent.std(axis=0)
    scale = np.where(deviation > 1e-9, deviation, 1.0)
    points = latent / scale
    squared = squared_distances(points, points)
    likeliest, found = -np.inf, (LENGTHS[0], np.zeros(len(objective)))
    # A grid in place of an optimiser: twelve factors of an n by n matrix, which is the whole cost
    # (decision 18). The variance of the process is that of the objective, 1, and not fitted.
    for length in LENGTHS:
        correlation = np.asfortranarray(np.exp(squared * (-0.5 / length**2)))
        for noise in NOISES:
            # A copy, as the factor takes its place; in the order of columns, as LAPACK has it.
            covariance = np.array(correlation, order="F")
            covariance.reshape(-1, order="F")[:: len(points) + 1] += noise
            # LAPACK's routines themselves: the checks of SciPy's functions take as long again.
            factor, failed = dpotrf(covariance, lower=1, clean=0, overwrite_a=1)
            if failed:
                raise np.linalg.LinAlgError(f"a covariance is singular: dpotrf returned {failed}")
            coefficients, _ = dpotrs(factor, objective, lower=1)
            # Rasmussen and Williams, "Gaussian processes for machine learning" (2006), eq. 2.30,
            # without its constant. Half the logarithm of the determinant is the sum of those on the
            # factor's diagonal.
            likelihood = -0.5 * objective @ coefficients - np.log(factor.diagonal()).sum()
            if likelihood > likeliest:
                likeliest, found = likelihood, (length, coefficients)
    return _Latent(
        mean=mean,
        directions=rotations / scale,
        points=points,
        length=found[0],
        coefficients=found[1],
    )


def latent_directions(features: FloatArray, objective: FloatArray, components: int) -> FloatArray:
    """Returns the directions in which the features vary together with the objective.

    Partial least squares of one target (PLS1; Wold et al., "PLS-regression", 2001). scikit-learn's
    warns and divides by zero if the features are exhausted before the components.

    Args:
        features: (n, e) of mean 0.
        objective: (n,) of mean 0.
        components: Greatest number of directions.

    Returns:
        (e, k) orthogonal over the training set; k is less than ``components`` if fewer explain
        everything, and at least 1.
    """
    left = features
    directions, loadings = [], []
    for _ in range(components):
        # The direction of the greatest covariance with the objective. The objective itself is not
        # deflated: what is left of the features is orthogonal to all scores before, so that the
        # part of it which they explain does not change this product.
        direction = left.T @ objective
        length = float(np.linalg.norm(direction))
        # Relative to n, as the product is a sum over the n points.
        if length <= 1e-9 * len(features):
            break
        direction /= length
        scores = left @ direction
        loading = left.T @ scores / (scores @ scores)
        left = left - np.outer(scores, loading)
        directions.append(direction)
        loadings.append(loading)
    # An objective that depends on nothing: all points coincide, and its mean is predicted.
    if not directions:
        return np.zeros((features.shape[1], 1))
    # The directions are those of the deflated features. For the features themselves: W (P'W)^-1,
    # with the directions W and the loadings P (Wold et al., the weights W*).
    found = np.stack(directions, axis=1)
    rotations: FloatArray = found @ np.linalg.inv(np.stack(loadings) @ found)
    return rotations


def squared_distances(first: FloatArray, second: FloatArray) -> FloatArray:
    """Returns the squared distances (q, n) between points (q, e) and (n, e)."""
    # |a|² + |b|² - 2ab: one product of matrices in place of an array of all differences (q, n, e).
    if first is second:
        # One half of a symmetric product is computed only.
        products = first @ second.T
        products *= -2.0
    else:
        products = (-2.0 * first) @ second.T
    products += np.einsum("ij,ij->i", first, first)[:, None]
    products += np.einsum("ij,ij->i", second, second)
    # For equal points the sum may be slightly negative by rounding.
    return np.maximum(products, 0.0, out=products)


def _products(first: FloatArray, second: FloatArray) -> FloatArray:
    """Returns the kernel (q, n) of all polynomials up to degree 2."""
    # Divided by e, so that values stay in 0..4 and the ridge means the same for any number of
    # features.
    kernel: FloatArray = (1.0 + first @ second.T / first.shape[1]) ** 2
    return kernel


def _solve_ridge(kernel: FloatArray, ridge: float, objectives: FloatArray) -> FloatArray:
    """Returns the coefficients (n, m) of a kernel (n, n) with a ridge; changes the kernel."""
    from scipy.linalg.lapack import dpotrf, dpotrs

    # Both kernels are positive semidefinite, and with the ridge definite: Cholesky's factor exists,
    # at half the cost of a general one.
    kernel.flat[:: len(kernel) + 1] += ridge
    # SciPy's ``solve`` also estimates the condition, which takes longer than the solution.
    factor, failed = dpotrf(np.asfortranarray(kernel), clean=0, overwrite_a=1)
    if failed:
        raise np.linalg.LinAlgError(f"a kernel is singular: dpotrf returned {failed}")
    coefficients, _ = dpotrs(factor, objectives)
    return np.asarray(coefficients)


def _centre_features(features: FloatArray) -> FloatArray:
    """Maps 0..1 to -1..1, so that the terms of first and second degree are not correlated."""
    return 2.0 * features - 1.0
