"""SAMOTA's searches on surrogates: MOSA, breeding, clusters, and the archive."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.search.genes import Block, Gene, GeneKind, GeneSpace, Part
from drivora_service.search.selection import fronts
from drivora_service.search.testers.samota.archive import Archive, Database
from drivora_service.search.testers.samota.breeding import Breeding, Region
from drivora_service.search.testers.samota.encoding import Encoding
from drivora_service.search.testers.samota.ensemble import Prediction
from drivora_service.search.testers.samota.local_search import LocalSearch, clusters_of
from drivora_service.search.testers.samota.mosa import (
    Found,
    Mosa,
    PreferenceSorting,
    preferred_rows,
)
from drivora_service.testing.gene_spaces import small_space

BREEDING = Breeding(crossover=0.75, tournament=10, step=0.1)


def flat(count: int) -> GeneSpace:
    genes = tuple(
        Gene(name=f"x_{i}", kind=GeneKind.CONTINUOUS, low=-1.0, high=3.0) for i in range(count)
    )
    return GeneSpace((Block(name="all", part=Part.WEATHER, start=0, genes=genes),))


class TestPreferenceSorting:
    # Rows 3 and 1 are the best of an objective each. Of the others, 0 dominates 2, which has no
    # other above it; 4 is dominated by all.
    objectives = np.array([[0.4, 0.4], [0.9, 0.1], [0.5, 0.4], [0.1, 0.9], [1.0, 1.0]])

    def test_by_hand(self) -> None:
        order = PreferenceSorting().select(self.objectives, 5, np.random.default_rng(0))
        assert order.tolist() == [3, 1, 0, 2, 4]

    def test_the_best_of_an_objective_survive_where_non_domination_would_not_tell(self) -> None:
        # All are non-dominated; by crowding alone the best of the third objective is in the middle.
        assert len(fronts(MANY)) == 1
        kept = PreferenceSorting().select(MANY, 3, np.random.default_rng(0))
        assert sorted(kept.tolist()) == sorted(MANY.argmin(axis=0).tolist())

    def test_of_equals_the_one_better_elsewhere_is_preferred(self) -> None:
        assert preferred_rows(np.array([[0.0, 0.9], [0.0, 0.5], [0.3, 0.2]])).tolist() == [1, 2]

    def test_the_best_of_several_objectives_counts_once(self) -> None:
        assert preferred_rows(np.array([[0.5, 0.5], [0.0, 0.0]])).tolist() == [1]

    @given(hnp.arrays(float, (8, 3), elements=st.floats(0.0, 1.0)), st.integers(1, 8))
    def test_the_best_of_each_objective_come_first_and_each_row_once(
        self, objectives: FloatArray, count: int
    ) -> None:
        order = PreferenceSorting().select(objectives, count, np.random.default_rng(0))
        assert len(set(order.tolist())) == count
        preferred = preferred_rows(objectives)
        assert set(order[: len(preferred)].tolist()) <= set(preferred.tolist())
        if count >= len(preferred):
            assert np.array_equal(objectives[order].min(axis=0), objectives.min(axis=0))


MANY = np.array(
    [
        [0.0, 1.0, 0.9],
        [1.0, 0.0, 0.8],
        [0.5, 0.5, 0.0],
        [0.2, 0.8, 0.5],
        [0.8, 0.2, 0.4],
    ]
)


class TestMosa:
    space = flat(5)
    targets = np.array([0.0, 1.0, 2.5])

    def predict(self, values: FloatArray) -> Prediction:
        """Three bowls; the surrogates disagree most where the first gene is greatest."""
        errors = np.mean((values[:, None, :] - self.targets[:, None]) ** 2, axis=2)
        return Prediction(objectives=errors, uncertainty=np.tile(values[:, :1], (1, 3)))

    def search(self, *, threshold: float = -1.0, generations: int = 60, **extra: object) -> Found:
        mosa = Mosa(
            generations=generations,
            threshold=threshold,
            selection=PreferenceSorting(),
            breeding=BREEDING,
        )
        random = np.random.default_rng(4)
        known = extra.get("known", lambda _: False)
        assert callable(known)
        predict = extra.get("predict", self.predict)
        assert callable(predict)
        start = self.space.sample(random, 40)
        return mosa.search(start, Region(space=self.space), np.array, predict, known, random)

    def test_it_finds_the_optimum_of_each_objective(self) -> None:
        found = self.search()
        for values, target in zip(found.best, self.targets, strict=True):
            assert values is not None
            assert np.sqrt(np.mean((values - target) ** 2)) < 0.2

    def test_it_finds_where_the_surrogates_disagree_most(self) -> None:
        for values in self.search().uncertain:
            assert values is not None
            assert values[0] > 2.9

    def test_an_objective_predicted_at_its_threshold_is_dropped(self) -> None:
        asked: list[int] = []

        class Noting(PreferenceSorting):
            def select(
                self, objectives: FloatArray, count: int, random: np.random.Generator
            ) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
                asked.append(objectives.shape[1])
                return PreferenceSorting().select(objectives, count, random)

        def predict(values: FloatArray) -> Prediction:
            said = self.predict(values)
            objectives = said.objectives - np.array([-1.0, 0.3, 9.0])
            return Prediction(objectives=objectives, uncertainty=said.uncertainty)

        random = np.random.default_rng(4)
        Mosa(generations=30, threshold=0.0, selection=Noting(), breeding=BREEDING).search(
            self.space.sample(random, 40),
            Region(space=self.space),
            np.array,
            predict,
            lambda _: False,
            random,
        )
        # The third is covered from the start, the second on the way, the first never.
        assert asked == sorted(asked, reverse=True)
        assert asked[0] == 2
        assert asked[-1] == 1
        assert len(asked) == 30

    def test_it_ends_where_all_are_predicted_covered(self) -> None:
        calls = []

        def predict(values: FloatArray) -> Prediction:
            calls.append(len(values))
            return self.predict(values)

        self.search(threshold=100.0, predict=predict)
        assert calls == [40]

    def test_known_candidates_are_left_out(self) -> None:
        found = self.search(known=lambda values: values[0] < 1.0)
        for values in (*found.best, *found.uncertain):
            assert values is not None
            assert values[0] >= 1.0
        assert self.search(known=lambda _: True).best == (None, None, None)


class TestBreeding:
    def test_children_are_within_the_bounds_and_differ_from_their_parents(self) -> None:
        space, random = small_space(), np.random.default_rng(0)
        parents = space.sample(random, 31)
        children = BREEDING.children(parents, Region(space=space), random)
        assert children.shape == parents.shape
        assert all(space.within(child) for child in children)
        assert not (children[:, None] == parents[None]).all(axis=2).all()

    def test_the_same_draws_give_the_same_children_and_parents_stay(self) -> None:
        space = small_space()
        parents = space.sample(np.random.default_rng(0), 10)
        before = parents.copy()
        one, other = (
            BREEDING.children(parents, Region(space=space), np.random.default_rng(1))
            for _ in range(2)
        )
        assert np.array_equal(one, other)
        assert np.array_equal(parents, before)

    def test_without_crossover_a_child_has_few_changes_from_one_parent(self) -> None:
        space, random = flat(20), np.random.default_rng(0)
        parents = space.sample(random, 40)
        breeding = Breeding(crossover=0.0, tournament=1, step=0.1)
        children = breeding.children(parents, Region(space=space), random)
        changes = (children[:, None] != parents[None]).sum(axis=2).min(axis=1)
        assert np.all(changes >= 1)
        # One gene for sure, and each with probability 1/20.
        assert 1.3 < changes.mean() < 2.7

    def test_crossover_keeps_actors_whole(self) -> None:
        space, random = small_space(), np.random.default_rng(0)
        parents = np.stack((space.lows, space.highs))
        parents[:, ~space.varies] = space.lows[~space.varies]

        class Nothing:
            def mutate(
                self,
                values: FloatArray,
                space: GeneSpace,
                random: np.random.Generator,
                *,
                strength: float = 1.0,
            ) -> FloatArray:
                return values

        breeding = Breeding(crossover=1.0, tournament=1, step=0.1, mutation=Nothing())
        mixed = 0
        for _ in range(40):
            for child in breeding.children(parents, Region(space=space), random):
                sides = [
                    np.array_equal(child[b.slice], space.highs[b.slice])
                    for b in space.blocks
                    if space.varies[b.slice].any()
                ]
                for block in space.blocks:
                    part = child[block.slice]
                    assert any(np.array_equal(part, parent[block.slice]) for parent in parents)
                mixed += 0 < sum(sides) < len(sides)
        assert mixed > 5

    def test_the_best_is_a_parent_more_often(self) -> None:
        space, random = flat(20), np.random.default_rng(0)
        parents = space.sample(random, 40)
        children = Breeding(crossover=0.0, tournament=10, step=0.1).children(
            parents, Region(space=space), random
        )
        nearest = (children[:, None] != parents[None]).sum(axis=2).argmin(axis=1)
        assert nearest.mean() < 8.0

    def test_the_ends_of_the_bounds_are_reached(self) -> None:
        space, random = flat(3), np.random.default_rng(0)
        values = space.sample(random, 50)
        for _ in range(200):
            values = BREEDING.children(values, Region(space=space), random)
        reached = np.concatenate(
            [BREEDING.children(values, Region(space=space), random) for _ in range(100)]
        )
        assert np.all(reached.min(axis=0) == -1.0)
        assert np.all(reached.max(axis=0) == 3.0)


class TestRegion:
    def test_it_is_the_box_around_the_members_and_has_their_categories(self) -> None:
        space, random = small_space(), np.random.default_rng(5)
        members = space.sample(random, 4)
        region = Region(space=space, members=members)
        drawn = region.sample(random, 500)
        assert np.all(drawn >= members.min(axis=0))
        assert np.all(drawn <= members.max(axis=0))
        for gene in np.flatnonzero(space.is_category):
            assert set(drawn[:, gene]) == set(members[:, gene])
        whole = space.is_whole & ~space.is_category
        assert np.array_equal(drawn[:, whole].max(axis=0), members[:, whole].max(axis=0))

    def test_children_stay_in_it(self) -> None:
        space, random = small_space(), np.random.default_rng(5)
        members = space.sample(random, 4)
        region = Region(space=space, members=members)
        values = region.sample(random, 20)
        for _ in range(20):
            values = BREEDING.children(values, region, random)
        assert np.all(values >= members.min(axis=0))
        assert np.all(values <= members.max(axis=0))
        for gene in np.flatnonzero(space.is_category):
            assert set(values[:, gene]) <= set(members[:, gene])


class TestClusters:
    def test_two_crowds_are_two_clusters_without_the_loner(self) -> None:
        random = np.random.default_rng(0)
        crowds = [centre + 0.02 * random.standard_normal((12, 3)) for centre in (0.2, 0.8)]
        points = np.concatenate((crowds[0], [[0.5, 3.0, -2.0]], crowds[1]))
        groups = clusters_of(points, 5)
        assert sorted(group.tolist() for group in groups) == [list(range(12)), list(range(13, 25))]

    @pytest.mark.parametrize("count", [1, 6, 9])
    def test_too_few_are_one(self, count: int) -> None:
        assert [g.tolist() for g in clusters_of(np.eye(count), 5)] == [list(range(count))]

    def test_each_cluster_of_the_best_gets_its_candidate(self) -> None:
        space = flat(3)
        encoding = Encoding(space)
        database, random = Database(encoding), np.random.default_rng(0)
        near = np.concatenate(
            [centre + 0.1 * random.standard_normal((10, 3)) for centre in (0.0, 2.0)]
        )
        for number, values in enumerate(np.concatenate((space.sample(random, 80), near))):
            apart = min(float(np.linalg.norm(values - centre)) for centre in (0.0, 2.0))
            database.add(number, values, {"o": apart})
        search = LocalSearch(top=0.2, cluster=5, generations=20, population=20, breeding=BREEDING)
        finds = search.search(database, 0, space, encoding, random)
        centres = sorted(round(float(find.values.mean())) for find in finds)
        assert centres == [0, 2]
        for find in finds:
            members = database.values[find.members]
            assert np.all(find.values >= members.min(axis=0))
            assert np.all(find.values <= members.max(axis=0))
            assert not database.knows(encoding.encode(find.values[None])[0])
            # Nearer to the centre than most of those that it was learnt from.
            centre = round(float(find.values.mean()))
            assert np.linalg.norm(find.values - centre) < np.median(
                np.linalg.norm(members - centre, axis=1)
            )


class TestDatabase:
    def database(self, objectives: list[dict[str, float | None]]) -> Database:
        space = flat(2)
        database = Database(Encoding(space))
        values = space.sample(np.random.default_rng(0), len(objectives))
        for number, (row, found) in enumerate(zip(values, objectives, strict=True)):
            database.add(10 + number, row, found)
        return database

    def test_what_is_not_measurable_is_worst(self) -> None:
        database = self.database([{"a": 0.2, "b": None}])
        assert database.objectives.tolist() == [[0.2, 1.0]]

    def test_the_objectives_take_turns_in_the_nearest(self) -> None:
        database = self.database(
            [{"a": a, "b": b} for a, b in ((0.1, 0.9), (0.2, 0.8), (0.9, 0.1), (0.5, 0.5))]
        )
        assert database.nearest(np.array([0, 1]), 3).tolist() == [0, 2, 1]
        assert database.nearest(np.array([0]), 9).tolist() == [0, 1, 3, 2]

    def test_the_training_set_keeps_the_nearest_and_the_first_and_last_of_the_others(self) -> None:
        values = np.random.default_rng(1).permutation(100).tolist()
        database = self.database([{"a": float(v)} for v in values])
        rows = database.training_rows(np.array([0]), 20)
        assert len(set(rows.tolist())) == 20
        assert rows.tolist() == sorted(rows)
        near = set(np.argsort(values)[:10].tolist())
        assert near <= set(rows.tolist())
        others = [row for row in range(100) if row not in near]
        assert {others[0], others[-1]} <= set(rows.tolist())
        assert database.training_rows(np.array([0]), 100).tolist() == list(range(100))


class TestArchive:
    def test_an_objective_is_covered_at_its_threshold(self) -> None:
        archive = Archive(0.1)
        archive.update(0, {"a": 0.11, "b": 0.1, "c": None})
        assert archive.covered == {"b"}
        assert archive.is_uncovered(("a", "b", "c")).tolist() == [True, False, True]

    def test_the_best_stays_and_the_first_of_equals(self) -> None:
        archive = Archive(0.0)
        for number, value in enumerate((0.5, 0.2, 0.2, 0.4)):
            archive.update(number, {"a": value})
        assert archive.best("a") == (0.2, 1)
        assert archive.best("b") is None

    def test_a_new_round_forgets_what_is_covered_but_not_the_best(self) -> None:
        archive = Archive(0.0)
        archive.update(0, {"a": 0.0})
        archive.begin_round()
        assert archive.covered == frozenset()
        assert archive.round == 1
        assert archive.best("a") == (0.0, 0)
