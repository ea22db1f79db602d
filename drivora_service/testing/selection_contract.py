"""The contract of selections, as a suite of tests for authors of selections.

Derive a class whose name begins with ``Test`` and give it the plug-in::

    class TestMySelection(SelectionContract):
        plugin = MY_PLUGIN

A selection that intentionally ignores the objectives sets ``looks = False``.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np
import pytest

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.search.plugin import SelectionPlugin


class SelectionContract:
    """Tests that every selection passes.

    Attributes:
        plugin: The selection under test.
        looks: Whether it prefers candidates for their objectives.
    """

    plugin: ClassVar[SelectionPlugin]
    looks: ClassVar[bool] = True

    def objectives(self) -> tuple[FloatArray, ...]:
        """Returns objectives of one or several columns; some are not measurable."""
        random = np.random.default_rng(1)
        several = random.normal(size=(12, 3))
        several[3] = np.nan
        several[5, 1] = np.nan
        one = random.normal(size=(8, 1))
        one[2] = np.nan
        return (
            one,
            several,
            np.array([[-3.0]]),
            np.zeros((5, 2)),
            np.full((4, 1), np.nan),
            np.full((4, 2), np.nan),
        )

    @pytest.mark.parametrize("count", [1, 4])
    def test_it_gives_as_many_as_are_wanted(self, count: int) -> None:
        selection = self.plugin.create()
        for objectives in self.objectives():
            before = objectives.copy()
            wanted = min(count, len(objectives))
            chosen = selection.select(objectives, wanted, np.random.default_rng(2))
            assert chosen.shape == (wanted,)
            assert chosen.dtype == np.int64
            assert ((chosen >= 0) & (chosen < len(objectives))).all()
            assert np.array_equal(objectives, before, equal_nan=True)

    def test_the_same_draws_give_the_same_choice(self) -> None:
        selection = self.plugin.create()
        for objectives in self.objectives():
            one = selection.select(objectives, 1, np.random.default_rng(3))
            assert np.array_equal(one, selection.select(objectives, 1, np.random.default_rng(3)))

    def test_the_better_is_chosen_more_often_than_the_worse(self) -> None:
        if self.looks:
            for m in (1, 3):
                often = self._how_often(np.repeat([[0.0], [1.0], [np.nan], [2.0]], m, axis=1))
                assert often[0] > often[3] >= often[2]
                assert often[0] >= often[1] >= often[3]

    def test_signs_and_scales_do_not_matter(self) -> None:
        if self.looks:
            for scale, shift in ((1.0, -100.0), (1e-6, 0.0), (1e6, 5.0)):
                often = self._how_often(np.array([[0.0], [1.0], [2.0]]) * scale + shift)
                assert often[0] > often[2]

    def _how_often(self, objectives: FloatArray) -> FloatArray:
        selection = self.plugin.create()
        random = np.random.default_rng(4)
        chosen = [selection.select(objectives, 1, random)[0] for _ in range(400)]
        return np.bincount(chosen, minlength=len(objectives)).astype(np.float64)
