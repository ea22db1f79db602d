"""The contract of mutations, as a suite of tests for authors of mutations.

Derive a class whose name begins with ``Test`` and give it the plug-in::

    class TestMyMutation(MutationContract):
        plugin = MY_PLUGIN
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from drivora_service.search.genes import Block, Gene, GeneKind, GeneSpace, Part
from drivora_service.search.plugin import MutationPlugin
from drivora_service.testing.gene_spaces import small_space


class MutationContract:
    """Tests that every mutation passes.

    Attributes:
        plugin: The mutation under test.
    """

    plugin: ClassVar[MutationPlugin]

    def spaces(self) -> tuple[GeneSpace, ...]:
        """Returns the spaces of the tests: a full one, and ones without some parts."""
        return (
            small_space(),
            small_space(egos=0, vehicles=0, walkers=0),
            small_space(egos=2, vehicles=1, walkers=0, slices=1),
        )

    def test_it_gives_a_changed_copy_within_the_bounds(self) -> None:
        mutation = self.plugin.create()
        random = np.random.default_rng(1)
        for space in self.spaces():
            for _ in range(100):
                parent = space.sample(random)
                before = parent.copy()
                child = mutation.mutate(parent, space, random)
                assert np.array_equal(parent, before)
                assert not np.shares_memory(parent, child)
                assert space.within(child)
                assert not np.array_equal(child, parent)

    def test_it_works_from_the_bounds(self) -> None:
        mutation = self.plugin.create()
        random = np.random.default_rng(2)
        for space in self.spaces():
            for parent in (space.lows, space.highs):
                for _ in range(50):
                    child = mutation.mutate(parent, space, random)
                    assert space.within(child)
                    assert not np.array_equal(child, parent)

    def test_the_same_draws_give_the_same_child(self) -> None:
        mutation = self.plugin.create()
        for space in self.spaces():
            parent = space.sample(np.random.default_rng(3))
            one = mutation.mutate(parent, space, np.random.default_rng(4))
            assert np.array_equal(one, mutation.mutate(parent, space, np.random.default_rng(4)))

    def test_it_can_change_every_gene_that_varies(self) -> None:
        mutation = self.plugin.create()
        random = np.random.default_rng(5)
        for space in self.spaces():
            changed = np.zeros(len(space), dtype=np.bool_)
            for _ in range(100 * len(space)):
                parent = space.sample(random)
                changed |= mutation.mutate(parent, space, random) != parent
            assert np.array_equal(changed, space.varies)

    def test_more_strength_changes_no_less(self) -> None:
        mutation = self.plugin.create()
        space = small_space()
        means = []
        for strength in (0.5, 1.0, 4.0):
            random = np.random.default_rng(6)
            changes = []
            for _ in range(400):
                parent = space.sample(random)
                child = mutation.mutate(parent, space, random, strength=strength)
                assert space.within(child)
                changes.append(np.abs(space.to_unit(child) - space.to_unit(parent)).sum())
            means.append(float(np.mean(changes)))
        assert means[1] >= 0.85 * means[0]
        assert means[2] >= 0.85 * means[1]

    def test_it_copes_with_a_space_in_which_nothing_varies(self) -> None:
        gene = Gene(name="green", kind=GeneKind.CONTINUOUS, low=5.0, high=5.0, unit="s")
        space = GeneSpace((Block(name="lights", part=Part.LIGHTS, start=0, genes=(gene,)),))
        child = self.plugin.create().mutate(np.array([5.0]), space, np.random.default_rng(7))
        assert np.array_equal(child, [5.0])
