"""k-means and silhouettes, compared with those of scikit-learn."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from sklearn.cluster import KMeans
from sklearn.metrics import silhouette_samples

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.search.testers.behavexplor.k_means import (
    distances_between,
    k_means,
    silhouettes,
)


def crowds(seed: int) -> FloatArray:
    random = np.random.default_rng(seed)
    rows, columns = int(random.integers(20, 600)), int(random.integers(1, 64))
    places = 3.0 * random.standard_normal((int(random.integers(1, 9)), columns))
    return places[random.integers(len(places), size=rows)] + random.standard_normal((rows, columns))


@pytest.mark.parametrize("seed", range(40))
def test_clusters_are_those_of_scikit_learn(seed: int) -> None:
    points = crowds(seed)
    count = 2 + seed % 18
    start = points[::2][:count].copy() if seed % 2 and len(points) >= 2 * count else None
    found = k_means(points, count, seed, start)
    init = "k-means++" if start is None else start
    expected = KMeans(count, init=init, n_init=1, random_state=seed).fit(points)
    assert found.labels.tolist() == expected.labels_.tolist()
    assert found.centres == pytest.approx(expected.cluster_centers_)
    assert found.inertia == pytest.approx(expected.inertia_)


@pytest.mark.parametrize("seed", range(20))
def test_silhouettes_are_those_of_scikit_learn(seed: int) -> None:
    points = crowds(seed)
    labels = np.random.default_rng(seed).integers(2 + seed % 5, size=len(points)) * 3
    # Alone in its cluster.
    labels[0] = 99
    found = silhouettes(distances_between(points), labels)
    assert found == pytest.approx(silhouette_samples(points, labels), abs=1e-6)
    assert found[0] == 0.0


def test_an_empty_cluster_takes_the_farthest_point() -> None:
    points = np.array([[0.0], [1.0], [2.0], [50.0]])
    start = np.array([[1.0], [900.0]])
    found = k_means(points, 2, 0, start)
    expected = KMeans(2, init=start, n_init=1).fit(points)
    assert found.labels.tolist() == expected.labels_.tolist() == [0, 0, 0, 1]
    assert found.centres.tolist() == pytest.approx(np.array([[1.0], [50.0]]))


def test_fewer_different_points_than_clusters() -> None:
    points = np.repeat(np.array([[0.0, 1.0], [5.0, 2.0]]), 10, axis=0)
    found = k_means(points, 5, 3)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        expected = KMeans(5, n_init=1, random_state=3).fit(points)
    assert found.inertia == pytest.approx(0.0)
    assert len(np.unique(found.labels)) == len(np.unique(expected.labels_)) == 2
    assert np.unique(found.labels[:10]).size == np.unique(found.labels[10:]).size == 1
