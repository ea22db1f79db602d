"""SAMOTA's surrogates and their ensemble, on functions with known values."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from sklearn.cross_decomposition import PLSRegression

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.search.testers.samota.ensemble import (
    Ensemble,
    fit_ensemble,
    validation_errors,
    weights,
)
from drivora_service.search.testers.samota.screening import add_screening, relevant_features
from drivora_service.search.testers.samota.surrogates import (
    Fit,
    Kriging,
    Polynomial,
    RadialBasis,
    Surrogate,
    latent_directions,
    squared_distances,
)

KRIGING: Fit = partial(Kriging.fit, components=4)
FITS: tuple[Fit, ...] = (RadialBasis.fit, Polynomial.fit, KRIGING)


def curved(points: FloatArray) -> FloatArray:
    """Two objectives: a product with a bend, and a bent slope."""
    return np.stack(
        (
            points[:, 0] * points[:, 1] + (points[:, 2] - 0.3) ** 2,
            np.sin(2.0 * points[:, 0]) + 0.5 * points[:, 3],
        ),
        axis=1,
    )


def points(count: int, width: int, seed: int) -> FloatArray:
    return np.random.default_rng(seed).random((count, width))


def relative_error(model: Surrogate, width: int, mean: FloatArray, scale: FloatArray) -> FloatArray:
    """Returns the error on new points as a share of what their mean would have."""
    new = points(300, width, 2)
    truth = (curved(new) - mean) / scale
    error: FloatArray = np.sqrt(np.mean((model.predict(new) - truth) ** 2, axis=0))
    return np.asarray(error / truth.std(axis=0))


@pytest.mark.parametrize("fit", FITS, ids=["radial basis", "polynomial", "kriging"])
@pytest.mark.parametrize("width", [5, 40])
def test_every_surrogate_predicts_better_than_the_mean(fit: Fit, width: int) -> None:
    known = points(120, width, 1)
    truth = curved(known)
    mean, scale = truth.mean(axis=0), truth.std(axis=0)
    error = relative_error(fit(known, (truth - mean) / scale), width, mean, scale)
    assert np.all(error < (0.5 if width == 5 else 0.85))


def test_the_ensemble_predicts_in_the_units_of_the_objectives() -> None:
    known = points(120, 5, 1)
    shifted = 100.0 + 20.0 * curved(known)
    ensemble = fit_ensemble(known, shifted, FITS, np.random.default_rng(0), folds=3)
    new = points(300, 5, 2)
    error = ensemble.predict(new).objectives - (100.0 + 20.0 * curved(new))
    assert np.all(np.sqrt(np.mean(error**2, axis=0)) < 0.3 * shifted.std(axis=0))


def test_the_polynomial_is_of_degree_two_with_products() -> None:
    known = points(400, 3, 1)
    truth = known[:, :1] * known[:, 1:2] + known[:, 2:3] ** 2
    model = Polynomial.fit(known, truth - truth.mean())
    diagonal = np.linspace(0.0, 1.0, 9)[:, None] * np.array([1.0, 1.0, 0.0]) + [0.0, 0.0, 0.5]
    said = model.predict(diagonal)[:, 0]
    assert np.diff(said, 3) == pytest.approx(np.zeros(6), abs=1e-9)
    # The product's own second difference, over steps of an eighth.
    assert np.diff(said, 2) == pytest.approx(np.full(7, 2.0 / 64.0), rel=0.1)


def test_radial_basis_functions_go_near_their_points() -> None:
    known = points(30, 5, 1)
    model = RadialBasis.fit(known, curved(known))
    assert model.predict(known) == pytest.approx(curved(known), abs=0.15)


class TestScreening:
    def test_it_finds_what_an_objective_depends_on(self) -> None:
        known = points(200, 100, 1)
        slope = known[:, 17] + known[:, 40]
        assert {17, 40} <= set(relevant_features(known, slope).tolist())
        middle = (known[:, 63] - 0.5) ** 2
        assert 63 in relevant_features(known, middle)

    def test_it_keeps_few_of_those_without_effect(self) -> None:
        known = points(200, 100, 1)
        noise = np.random.default_rng(2).random(200)
        assert 4 <= len(relevant_features(known, noise)) <= 6

    def test_it_keeps_all_of_few(self) -> None:
        assert relevant_features(points(20, 3, 1), np.ones(20)).tolist() == [0, 1, 2]

    def test_features_that_never_change_are_not_relevant(self) -> None:
        known = points(50, 10, 1)
        known[:, :6] = 0.5
        assert relevant_features(known, known[:, 8]).min() >= 6

    @pytest.mark.parametrize("fit", FITS, ids=["radial basis", "polynomial", "kriging"])
    def test_it_helps_every_surrogate_among_many_features(self, fit: Fit) -> None:
        known = points(150, 100, 1)
        truth = curved(known)
        scaled = (truth - truth.mean(axis=0)) / truth.std(axis=0)
        plain, better = validation_errors(
            known, scaled, (fit, *add_screening(fit)), np.random.default_rng(0), folds=3
        )
        assert np.all(better < plain - 0.05)
        assert np.all(better < 0.75)


class TestLatentDirections:
    def test_they_are_those_of_partial_least_squares(self) -> None:
        known = points(50, 12, 1)
        target = curved(known)[:, 0]
        centred = known - known.mean(axis=0)
        found = latent_directions(centred, target - target.mean(), 4)
        reference = PLSRegression(n_components=4, scale=False).fit(known, target)
        assert np.abs(found) == pytest.approx(np.abs(reference.x_rotations_), abs=1e-9)

    def test_they_are_as_few_as_explain_everything(self) -> None:
        known = np.zeros((20, 6))
        known[:, 2] = np.linspace(-1.0, 1.0, 20)
        found = latent_directions(known, 3.0 * known[:, 2], 4)
        assert np.abs(found) == pytest.approx(np.eye(6)[:, 2:3])

    def test_there_is_one_even_where_nothing_is_explained(self) -> None:
        assert latent_directions(np.zeros((20, 6)), np.ones(20), 4).tolist() == [[0.0]] * 6


class TestDegenerateData:
    @pytest.mark.parametrize("fit", FITS, ids=["radial basis", "polynomial", "kriging"])
    def test_equal_points_and_few_points(self, fit: Fit) -> None:
        known = np.repeat(points(2, 4, 1), 3, axis=0)
        model = fit(known, np.tile([[1.0], [-1.0]], (3, 1)))
        assert np.isfinite(model.predict(points(9, 4, 2))).all()

    @pytest.mark.parametrize("fit", FITS, ids=["radial basis", "polynomial", "kriging"])
    def test_an_objective_of_two_values_that_one_feature_decides(self, fit: Fit) -> None:
        known = points(40, 10, 1).round()
        model = fit(known, 2.0 * known[:, :1] - 1.0)
        predicted = model.predict(known)[:, 0]
        assert np.array_equal(predicted > 0.0, known[:, 0] == 1.0)


class _Says:
    def __init__(self, *values: float) -> None:
        self._values = np.array(values)

    def predict(self, features: FloatArray) -> FloatArray:
        return np.tile(self._values, (len(features), 1))


def test_the_mean_is_weighted_and_the_uncertainty_is_the_largest_disagreement() -> None:
    ensemble = Ensemble(
        surrogates=(_Says(1.0, 0.0), _Says(2.0, 0.0), _Says(4.0, 0.0)),
        weights=np.array([[0.5, 1.0], [0.3, 0.0], [0.2, 0.0]]),
        mean=np.array([10.0, 7.0]),
        deviation=np.array([2.0, 1.0]),
    )
    said = ensemble.predict(np.zeros((2, 3)))
    assert said.objectives == pytest.approx(np.array([[10.0 + 2.0 * 1.9, 7.0]] * 2))
    assert said.uncertainty == pytest.approx(np.array([[6.0, 0.0]] * 2))


def test_weights_by_hand() -> None:
    found = weights(np.array([[1.0, 0.0], [2.0, 0.0], [5.0, 0.0]]))
    assert found[:, 0] == pytest.approx([7.0 / 16.0, 6.0 / 16.0, 3.0 / 16.0])
    assert found[:, 1] == pytest.approx([1.0 / 3.0] * 3)


@given(hnp.arrays(float, (3, 4), elements=st.floats(0.0, 1e6)))
def test_weights_are_shares_and_a_smaller_error_weighs_no_less(errors: FloatArray) -> None:
    found = weights(errors)
    assert np.all(found >= 0.0)
    assert found.sum(axis=0) == pytest.approx(np.ones(4))
    for column, shares in zip(errors.T, found.T, strict=True):
        assert np.all(np.diff(shares[np.argsort(column, kind="stable")]) <= 1e-9)


@given(hnp.arrays(float, (5, 3), elements=st.floats(0.0, 1.0)))
def test_squared_distances_are_those_of_the_definition(rows: FloatArray) -> None:
    expected = np.sum((rows[:, None] - rows[None, :2]) ** 2, axis=2)
    assert squared_distances(rows, rows[:2]) == pytest.approx(expected, abs=1e-12)
