"""Density clusters, compared with those of scikit-learn."""

from __future__ import annotations

import numpy as np
import pytest
from sklearn.cluster import HDBSCAN

from drivora_service.search.testers.samota.density import density_clusters


@pytest.mark.parametrize("seed", range(80))
def test_clusters_are_those_of_scikit_learn_in_the_same_order(seed: int) -> None:
    random = np.random.default_rng(seed)
    rows, columns = int(random.integers(10, 150)), int(random.integers(1, 60))
    least = int(random.integers(2, 8))
    places = random.integers(4, size=(rows, 1)) * random.random(columns) * random.random()
    points = 0.6 * random.random((rows, columns)) + places
    if seed % 4 == 0:
        # Equal distances, and equal points.
        points = np.round(points, 1)
    labels = HDBSCAN(min_cluster_size=least, copy=True).fit(points).labels_
    expected = [np.flatnonzero(labels == label).tolist() for label in range(labels.max() + 1)]
    assert [group.tolist() for group in density_clusters(points, least)] == expected


def test_points_without_a_gap_are_no_cluster() -> None:
    assert density_clusters(np.linspace(0.0, 1.0, 30)[:, None], 5) == ()


def test_a_cluster_in_a_cluster_is_found_instead_of_the_outer_one() -> None:
    random = np.random.default_rng(0)
    centres = ((0.0, 0.0), (1.0, 0.0), (20.0, 0.0))
    points = np.concatenate(
        [np.array(centre) + 0.01 * random.standard_normal((20, 2)) for centre in centres]
    )
    found = [group.tolist() for group in density_clusters(points, 5)]
    assert sorted(found) == [list(range(k, k + 20)) for k in (0, 20, 40)]
