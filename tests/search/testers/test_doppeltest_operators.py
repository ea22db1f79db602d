"""DoppelTest's sections, seeds, crossover and mutation: their changes and probabilities."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivora_service.geometry.array_shapes import BoolArray, FloatArray
from drivora_service.search.genes import Part
from drivora_service.search.testers.doppeltest.chromosome import Chromosome
from drivora_service.search.testers.doppeltest.crossover import DoppelTestCrossover
from drivora_service.search.testers.doppeltest.mutation import DoppelTestMutation
from drivora_service.search.testers.doppeltest.parameters import DoppelTestParameters
from drivora_service.search.testers.doppeltest.sections import ActorSection
from drivora_service.search.testers.doppeltest.seeds import draw_seed
from drivora_service.testing.gene_spaces import small_space

SPACE = small_space(egos=5, walkers=4)
EGOS, WALKERS, LIGHTS = SPACE.of(Part.EGO), SPACE.of(Part.WALKER), SPACE.of(Part.LIGHTS)[0]
CHROMOSOME = Chromosome(SPACE, None)
ONLY_EGOS = DoppelTestParameters(cross_egos=1.0, cross_walkers=0.0)
ONLY_WALKERS = DoppelTestParameters(cross_egos=0.0, cross_walkers=1.0)
ONLY_LIGHTS = DoppelTestParameters(cross_egos=0.0, cross_walkers=0.0)
TIMES = 2_000

Ego = tuple[float, float, float]


def conflicting(*pairs: tuple[int, int]) -> BoolArray:
    """Returns the conflicts of six paths, of which only these pairs conflict."""
    matrix = np.zeros((6, 6), dtype=np.bool_)
    for one, other in pairs:
        matrix[one, other] = matrix[other, one] = True
    return matrix


def candidate(
    *egos: Ego, walkers: int = 0, chromosome: Chromosome = CHROMOSOME, seed: int = 0
) -> FloatArray:
    """Returns a candidate of egos (path, start, start time) and a number of walkers."""
    values = draw_seed(chromosome, np.random.default_rng(seed))
    chromosome.egos.fill(values, [np.array([1.0, *ego]) for ego in egos])
    drawn = np.random.default_rng(seed + 1)
    chromosome.walkers.fill(values, [chromosome.walkers.draw(SPACE, drawn) for _ in range(walkers)])
    return values


def egos_of(values: FloatArray) -> list[Ego]:
    """Returns path, start and start time of every ego."""
    actors = CHROMOSOME.egos.actors(values)
    return [(float(ego[1]), float(ego[2]), float(ego[3])) for ego in actors]


def walkers_of(values: FloatArray) -> list[bytes]:
    return [walker.tobytes() for walker in CHROMOSOME.walkers.actors(values)]


def changed_parts(one: FloatArray, other: FloatArray) -> set[Part]:
    return {b.part for b in SPACE.blocks if not np.array_equal(one[b.slice], other[b.slice])}


def crossed(
    first: FloatArray,
    second: FloatArray,
    parameters: DoppelTestParameters = ONLY_EGOS,
    chromosome: Chromosome = CHROMOSOME,
    times: int = TIMES,
) -> list[FloatArray]:
    random = np.random.default_rng(0)
    crossover = DoppelTestCrossover(chromosome=chromosome, parameters=parameters)
    before = first.copy(), second.copy()
    children = [crossover.cross(first, second, random) for _ in range(times)]
    assert np.array_equal(first, before[0])
    assert np.array_equal(second, before[1])
    return children


def mutated(
    values: FloatArray, chromosome: Chromosome = CHROMOSOME, times: int = TIMES
) -> list[FloatArray]:
    random = np.random.default_rng(0)
    mutation = DoppelTestMutation(chromosome=chromosome, parameters=DoppelTestParameters())
    before = values.copy()
    children = [mutation.mutate(values, SPACE, random) for _ in range(times)]
    assert np.array_equal(values, before)
    return children


class TestSections:
    """Actors in slots."""

    def section(self) -> tuple[ActorSection, FloatArray]:
        values = candidate((1, 0.1, 0), (2, 0.2, 0), (3, 0.3, 0), (4, 0.4, 0))
        return CHROMOSOME.egos, values

    def test_an_actor_is_added_to_the_first_empty_slot(self) -> None:
        egos, values = self.section()
        egos.remove(values, 2)
        egos.add(values, np.array([1.0, 5.0, 0.5, 0.0]))
        assert [path for path, _, _ in egos_of(values)] == [1, 2, 5, 4]

    def test_removing_an_actor_does_not_move_the_others(self) -> None:
        egos, values = self.section()
        egos.remove(values, 2)
        assert egos.taken_slots(values) == [0, 1, 3]
        assert [path for path, _, _ in egos_of(values)] == [1, 2, 4]

    def test_a_slot_that_is_never_empty_is_filled_again(self) -> None:
        egos, values = self.section()
        egos.remove(values, 0)
        assert [path for path, _, _ in egos_of(values)] == [4, 2, 3]
        assert SPACE.within(values)

    def test_empty_slots_are_all_alike(self) -> None:
        one = candidate((1, 0.1, 0), (2, 0.2, 0))
        other = candidate((1, 0.1, 0), (2, 0.2, 0), (3, 0.9, 7.0))
        CHROMOSOME.egos.remove(other, 2)
        assert np.array_equal(one, other)

    def test_numbers_of_egos_at_the_limits(self) -> None:
        assert (CHROMOSOME.egos.least, CHROMOSOME.egos.most) == (2, 5)
        assert (CHROMOSOME.walkers.least, CHROMOSOME.walkers.most) == (0, 4)


class TestSeeds:
    """The first generation."""

    @given(st.integers(0, 2**32 - 1))
    def test_every_seed_is_within_and_has_a_conflict(self, seed: int) -> None:
        chromosome = Chromosome(SPACE, conflicting((0, 1), (2, 5)))
        values = draw_seed(chromosome, np.random.default_rng(seed))
        assert SPACE.within(values)
        paths = set(chromosome.paths(values))
        assert {0.0, 1.0} <= paths or {2.0, 5.0} <= paths

    def test_a_conflict_is_found_where_hardly_any_is(self) -> None:
        space = small_space(egos=2)
        path = space.of(Part.EGO)[0].genes[1]
        assert path.high == 5.0
        chromosome = Chromosome(space, conflicting((4, 5)))
        for seed in range(20):
            values = draw_seed(chromosome, np.random.default_rng(seed))
            assert set(chromosome.paths(values)) == {4.0, 5.0}

    def test_every_number_of_egos_and_walkers_is_as_likely(self) -> None:
        random = np.random.default_rng(0)
        seeds = [draw_seed(CHROMOSOME, random) for _ in range(TIMES)]
        egos = Counter(len(egos_of(values)) for values in seeds)
        walkers = Counter(len(walkers_of(values)) for values in seeds)
        assert sorted(egos) == [2, 3, 4, 5]
        # Few egos conflict less often, and are drawn again.
        assert all(egos[n] / TIMES == pytest.approx(0.25, abs=0.06) for n in egos)
        assert sorted(walkers) == [0, 1, 2, 3, 4]
        assert all(walkers[n] / TIMES == pytest.approx(0.2, abs=0.04) for n in walkers)

    def test_the_first_ego_starts_at_once(self) -> None:
        random = np.random.default_rng(0)
        for _ in range(50):
            times = [time for _, _, time in egos_of(draw_seed(CHROMOSOME, random))]
            assert min(times) == 0.0
            assert max(times) <= 15.0


class TestMutation:
    """One section changes."""

    def test_the_sections_change_as_often(self) -> None:
        values = candidate((1, 0.5, 0), (2, 0.5, 3), (3, 0.5, 5), walkers=2)
        found = Counter(frozenset(changed_parts(values, child)) for child in mutated(values))
        sections = [Part.EGO, Part.WALKER, Part.LIGHTS]
        assert set(found) == {frozenset({part}) for part in sections}
        shares = [found[frozenset({part})] / TIMES for part in sections]
        assert shares == pytest.approx([1 / 3] * 3, abs=0.04)

    def ego_changes(self, *egos: Ego) -> tuple[Counter[int], list[list[Ego]]]:
        values = candidate(*egos)
        children = [c for c in mutated(values) if changed_parts(values, c) == {Part.EGO}]
        lists = [egos_of(child) for child in children]
        return Counter(len(found) - len(egos) for found in lists), lists

    def test_egos_are_removed_added_and_redrawn(self) -> None:
        numbers, _ = self.ego_changes((1, 0.5, 0), (2, 0.5, 3), (3, 0.5, 5))
        shares = [numbers[change] / numbers.total() for change in (-1, 1, 0)]
        assert shares == pytest.approx([0.1, 0.3, 0.6], abs=0.05)

    def test_two_egos_are_left_and_five_are_the_most(self) -> None:
        fewest, _ = self.ego_changes((1, 0.5, 0), (2, 0.5, 3))
        assert sorted(fewest) == [0, 1]
        full = [(float(i), 0.5, float(i)) for i in range(5)]
        most, _ = self.ego_changes(*full)
        assert sorted(most) == [-1, 0]

    def test_an_ego_that_is_redrawn_keeps_its_route(self) -> None:
        egos = [(1.0, 0.5, 0.0), (2.0, 0.5, 0.0), (3.0, 0.5, 0.0)]
        _, lists = self.ego_changes(*egos)
        redrawn = [found for found in lists if len(found) == 3]
        assert {tuple(path for path, _, _ in found) for found in redrawn} == {(1.0, 2.0, 3.0)}
        for found in redrawn:
            moved = [new for new, old in zip(found, egos, strict=True) if new[1] != old[1]]
            assert len(moved) == 1
        assert len({found[0][1] for found in redrawn}) > 100

    def test_the_first_ego_starts_at_once_whatever_is_redrawn(self) -> None:
        _, lists = self.ego_changes((1, 0.5, 0), (2, 0.5, 9), (3, 0.5, 9))
        assert all(min(time for _, _, time in found) == 0.0 for found in lists)

    def test_an_ego_that_is_added_gets_in_anothers_way(self) -> None:
        chromosome = Chromosome(SPACE, conflicting((0, 1), (2, 3), (3, 4)))
        values = candidate((0, 0.5, 0), (3, 0.5, 3), chromosome=chromosome)
        added = [
            egos_of(child)[2][0]
            for child in mutated(values, chromosome)
            if len(egos_of(child)) == 3
        ]
        assert set(added) == {1.0, 2.0, 4.0}

    def test_walkers_are_removed_added_and_redrawn(self) -> None:
        values = candidate((1, 0.5, 0), (2, 0.5, 3), walkers=2)
        children = [c for c in mutated(values) if changed_parts(values, c) == {Part.WALKER}]
        numbers = Counter(len(walkers_of(child)) - 2 for child in children)
        shares = [numbers[change] / numbers.total() for change in (-1, 1, 0)]
        assert shares == pytest.approx([0.2, 0.2, 0.6], abs=0.05)

    def test_a_walker_that_is_redrawn_crosses_at_the_same_place(self) -> None:
        values = candidate((1, 0.5, 0), (2, 0.5, 3), walkers=1)
        kept = [WALKERS[0].index(name) for name in ("path", "place", "side")]
        drawn = [WALKERS[0].index(name) for name in ("angle", "speed", "start_time")]
        redrawn = [
            child
            for child in mutated(values)
            if changed_parts(values, child) == {Part.WALKER} and len(walkers_of(child)) == 1
        ]
        assert len(redrawn) > 100
        for child in redrawn:
            assert np.array_equal(child[kept], values[kept])
            assert (child[drawn] != values[drawn]).all()

    def test_a_walker_is_added_if_there_is_none(self) -> None:
        values = candidate((1, 0.5, 0), (2, 0.5, 3))
        children = [c for c in mutated(values) if changed_parts(values, c) == {Part.WALKER}]
        assert {len(walkers_of(child)) for child in children} == {1}

    def test_mostly_one_time_of_the_lights_changes(self) -> None:
        values = candidate((1, 0.5, 0), (2, 0.5, 3))
        numbers = Counter(
            int((child[LIGHTS.slice] != values[LIGHTS.slice]).sum())
            for child in mutated(values)
            if changed_parts(values, child) == {Part.LIGHTS}
        )
        assert sorted(numbers) == [1, 2]
        assert numbers[2] / numbers.total() == pytest.approx(0.1, abs=0.04)

    def test_more_strength_changes_more_sections(self) -> None:
        values = candidate((1, 0.5, 0), (2, 0.5, 3), walkers=2)
        mutation = DoppelTestMutation(chromosome=CHROMOSOME, parameters=DoppelTestParameters())
        random = np.random.default_rng(0)
        children = [mutation.mutate(values, SPACE, random, strength=6.0) for _ in range(100)]
        assert np.mean([len(changed_parts(values, child)) for child in children]) > 2.0

    @given(st.integers(0, 2**32 - 1))
    def test_mutants_are_within_the_bounds(self, seed: int) -> None:
        random = np.random.default_rng(seed)
        values = draw_seed(CHROMOSOME, random)
        mutation = DoppelTestMutation(chromosome=CHROMOSOME, parameters=DoppelTestParameters())
        for _ in range(10):
            values = mutation.mutate(values, SPACE, random)
            assert SPACE.within(values)
            assert 2 <= len(egos_of(values)) <= 5


class TestCrossover:
    """One section of a parent is changed by the other's."""

    FIRST = candidate((1, 0.1, 0), (2, 0.2, 3), walkers=1, seed=1)
    SECOND = candidate((4, 0.6, 0), (5, 0.7, 4), (3, 0.8, 6), walkers=2, seed=5)

    def test_the_sections_take_part_in_their_shares(self) -> None:
        children = crossed(self.FIRST, self.SECOND, DoppelTestParameters())
        found = Counter(frozenset(changed_parts(self.FIRST, child)) for child in children)
        assert all(len(parts) <= 1 for parts in found)
        shares = [found[frozenset({part})] / TIMES for part in (Part.EGO, Part.LIGHTS)]
        assert shares == pytest.approx([0.6, 0.2], abs=0.04)
        # Some of both parents' walkers may be just the first's.
        assert 0.1 < found[frozenset({Part.WALKER})] / TIMES < 0.2

    def test_egos_on_the_same_path_take_over_place_or_time(self) -> None:
        first = candidate((1, 0.1, 0), (2, 0.2, 3))
        second = candidate((1, 0.6, 0), (2, 0.7, 4), (3, 0.8, 6))
        children = [egos_of(child) for child in crossed(first, second)]
        found = Counter(tuple(child) for child in children if len(child) == 2)
        one = [(1.0, 0.1, 0.0), (1.0, 0.6, 0.0)]
        other = [(2.0, 0.2, 4.0), (2.0, 0.7, 3.0)]
        assert set(found) == {(a, b) for a in one for b in other}
        assert all(
            count / found.total() == pytest.approx(0.25, abs=0.04) for count in found.values()
        )

    def test_sometimes_all_egos_are_taken_over(self) -> None:
        first = candidate((1, 0.1, 0), (2, 0.2, 3))
        second = candidate((1, 0.6, 0), (2, 0.7, 4), (3, 0.8, 6))
        children = [egos_of(child) for child in crossed(first, second)]
        share = np.mean([child == egos_of(second) for child in children])
        assert share == pytest.approx(0.05, abs=0.02)

    def test_the_others_first_ego_that_conflicts_is_added(self) -> None:
        chromosome = Chromosome(SPACE, conflicting((2, 5), (2, 3), (1, 0)))
        children = crossed(self.FIRST, self.SECOND, chromosome=chromosome)
        found = Counter(tuple(egos_of(child)) for child in children)
        added = (*egos_of(self.FIRST), egos_of(self.SECOND)[1])
        assert found[added] / TIMES == pytest.approx(0.95, abs=0.02)

    def test_where_nothing_conflicts_both_parents_egos_are_shuffled(self) -> None:
        chromosome = Chromosome(SPACE, conflicting((0, 1)))
        children = [egos_of(c) for c in crossed(self.FIRST, self.SECOND, chromosome=chromosome)]
        pool = {1.0, 2.0, 3.0, 4.0, 5.0}
        assert {len(child) for child in children} == {2, 3, 4, 5}
        for child in children:
            paths = [path for path, _, _ in child]
            assert len(set(paths)) == len(paths)
            assert set(paths) <= pool

    def test_no_ego_is_added_to_five(self) -> None:
        full = candidate(*[(float(i), 0.1 * i, float(i)) for i in range(5)])
        other = candidate((5, 0.5, 0), (5, 0.6, 2))
        assert all(2 <= len(egos_of(child)) <= 5 for child in crossed(full, other))

    def test_walkers_are_some_of_both_parents(self) -> None:
        children = crossed(self.FIRST, self.SECOND, ONLY_WALKERS)
        pool = set(walkers_of(self.FIRST)) | set(walkers_of(self.SECOND))
        found = [walkers_of(child) for child in children]
        assert len(pool) == 3
        assert {walker for walkers in found for walker in walkers} == pool
        numbers = Counter(len(walkers) for walkers in found)
        assert sorted(numbers) == [0, 1, 2, 3]
        # A tenth of the children take over both of the second's walkers.
        assert numbers[0] / TIMES == pytest.approx(0.9 / 4, abs=0.03)
        assert numbers[2] / TIMES == pytest.approx(0.9 / 4 + 0.1, abs=0.03)

    def test_mostly_one_time_of_the_lights_is_taken_over(self) -> None:
        children = crossed(self.FIRST, self.SECOND, ONLY_LIGHTS)
        taken = [child[LIGHTS.slice] == self.SECOND[LIGHTS.slice] for child in children]
        assert np.mean([bool(both.all()) for both in taken]) == pytest.approx(0.1, abs=0.03)
        assert np.mean([bool(both[0]) for both in taken]) == pytest.approx(0.55, abs=0.04)

    def test_a_section_that_the_space_lacks_leaves_its_share_to_the_others(self) -> None:
        space = small_space(egos=5, walkers=0)
        chromosome = Chromosome(space, None)
        random = np.random.default_rng(0)
        first, second = draw_seed(chromosome, random), draw_seed(chromosome, random)
        crossover = DoppelTestCrossover(chromosome=chromosome, parameters=DoppelTestParameters())
        lights = space.of(Part.LIGHTS)[0].slice
        children = [crossover.cross(first, second, random) for _ in range(TIMES)]
        share = np.mean([not np.array_equal(c[lights], first[lights]) for c in children])
        assert share == pytest.approx(0.25, abs=0.03)

    @given(st.integers(0, 2**32 - 1))
    def test_children_are_within_the_bounds(self, seed: int) -> None:
        random = np.random.default_rng(seed)
        parents = [draw_seed(CHROMOSOME, random) for _ in range(2)]
        crossover = DoppelTestCrossover(chromosome=CHROMOSOME, parameters=DoppelTestParameters())
        for _ in range(10):
            child = crossover.cross(parents[0], parents[1], random)
            assert SPACE.within(child)
            assert 2 <= len(egos_of(child)) <= 5
            assert min(time for _, _, time in egos_of(child)) == 0.0
