"""Chains of neighbours among few failures are those that SciPy's search tree finds."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

from drivora_service.campaigns.search.failure_grouping import chains_of_few, chains_of_many, scale


@pytest.mark.parametrize("on_a_grid", [True, False])
def test_they_are_those_of_the_search_tree(on_a_grid: bool) -> None:
    rng = np.random.default_rng(5)
    several = 0
    for _ in range(300):
        count, features = int(rng.integers(1, 80)), int(rng.integers(1, 14))
        # On a grid, many distances are exactly the radius.
        steps = rng.integers(2, 8) if on_a_grid else 1 << 40
        drawn = rng.integers(0, steps, (count, features)) / (steps - 1)
        points = scale(drawn) / np.sqrt(features)
        radius = float(rng.choice([0.1, 0.15, 0.3, 1.0 / (steps - 1) / np.sqrt(features)]))
        few = chains_of_few(points, radius)
        np.testing.assert_array_equal(few, chains_of_many(points, radius))
        several += 1 < few.max() + 1 < count
    assert several > 50


def test_a_chain_is_numbered_by_its_first_point() -> None:
    points = np.array([[0.0], [9.0], [0.4], [5.0], [9.5], [0.8]])
    assert chains_of_few(points, 0.5).tolist() == [0, 1, 0, 2, 1, 0]
    assert chains_of_many(points, 0.5).tolist() == [0, 1, 0, 2, 1, 0]


def test_few_failures_are_grouped_without_scipy() -> None:
    program = (
        "import sys, numpy as np\n"
        "from drivora_service.campaigns.search.failure_grouping import Grouping\n"
        "groups = Grouping()._label(np.array([[0.0, 0.0], [0.1, 0.0], [5.0, 5.0]]))\n"
        "print(groups.tolist(), 'scipy' in sys.modules)"
    )
    ended = subprocess.run(
        [sys.executable, "-c", program], check=True, capture_output=True, text=True
    )
    assert ended.stdout.strip() == "[0, 0, 1] False"
