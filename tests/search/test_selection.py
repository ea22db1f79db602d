"""Selections: the contract, and the preferences of each."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from pymoo.operators.survival.rank_and_crowding.metrics import get_crowding_function
from pymoo.util.nds.non_dominated_sorting import NonDominatedSorting

from drivora_service.errors import SearchError
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.search.selection import (
    RANDOM_SELECTION,
    ROULETTE,
    TOURNAMENT,
    TRUNCATION,
    RandomSelection,
    Roulette,
    Tournament,
    Truncation,
    best_first,
    crowding_distances,
    fronts,
    measurable,
)
from drivora_service.testing.selection_contract import SelectionContract

OBJECTIVES = st.integers(1, 3).flatmap(
    lambda m: st.integers(1, 12).flatmap(
        lambda n: arrays(
            np.float64,
            (n, m),
            elements=st.one_of(st.integers(-5, 5).map(float), st.just(np.nan), st.just(np.inf)),
        )
    )
)


class TestTruncation(SelectionContract):
    plugin = TRUNCATION


class TestTournament(SelectionContract):
    plugin = TOURNAMENT


class TestRoulette(SelectionContract):
    plugin = ROULETTE


class TestRandomSelection(SelectionContract):
    plugin = RANDOM_SELECTION
    looks = False


def dominates(one: FloatArray, other: FloatArray) -> bool:
    return bool((one <= other).all() and (one < other).any())


@given(OBJECTIVES)
def test_fronts_contain_each_candidate_once_and_none_dominated_within(
    objectives: FloatArray,
) -> None:
    found = fronts(objectives)
    assert sorted(np.concatenate(found)) == list(range(len(objectives)))
    numbers = measurable(objectives)
    for front in found:
        assert not any(dominates(numbers[a], numbers[b]) for a in front for b in front)
    for before, behind in pairwise(found):
        assert all(any(dominates(numbers[a], numbers[b]) for a in before) for b in behind)


@given(OBJECTIVES)
def test_the_order_contains_each_candidate_and_respects_dominance(
    objectives: FloatArray,
) -> None:
    order = best_first(objectives)
    assert sorted(order) == list(range(len(objectives)))
    numbers = measurable(objectives)
    for place, index in enumerate(order):
        assert not any(dominates(numbers[other], numbers[index]) for other in order[place + 1 :])


def test_what_is_not_measurable_is_worse_than_any_number() -> None:
    objectives = np.array([[np.nan], [1e9], [-1e9], [np.inf]])
    assert list(best_first(objectives)) == [2, 1, 0, 3]
    half = np.array([[0.0, np.nan], [0.0, 7.0]])
    assert [list(front) for front in fronts(half)] == [[1], [0]]


def test_of_one_front_those_with_more_room_come_first() -> None:
    line = np.array([[0.0, 10.0], [1.0, 9.0], [1.5, 8.5], [6.0, 4.0], [10.0, 0.0]])
    assert set(best_first(line)[:2]) == {0, 4}
    assert best_first(line)[2] == 3
    room = crowding_distances(line)
    assert np.isinf(room[[0, 4]]).all()
    # NSGA-II: the mean over the objectives of the way between both neighbours, over the range.
    assert room[2] == pytest.approx((6.0 - 1.0) / 10.0)


def test_nothing_to_choose_from_is_an_error() -> None:
    with pytest.raises(SearchError, match="at least 1 candidate"):
        Truncation().select(np.empty((0, 2)), 1, np.random.default_rng(0))


def test_truncation_takes_the_best_in_order_and_goes_round() -> None:
    objectives = np.array([[3.0], [1.0], [2.0]])
    random = np.random.default_rng(0)
    assert list(Truncation().select(objectives, 2, random)) == [1, 2]
    assert list(Truncation().select(objectives, 5, random)) == [1, 2, 0, 1, 2]


def test_a_tournament_of_two_chooses_as_two_draws_without_repetition_do() -> None:
    objectives = np.array([[0.0], [1.0], [2.0]])
    chosen = Tournament().select(objectives, 6000, np.random.default_rng(0))
    assert np.bincount(chosen, minlength=3) / 6000 == pytest.approx([2 / 3, 1 / 3, 0], abs=0.03)
    assert list(chosen) == sorted(chosen)


def test_a_tournament_of_all_chooses_the_best() -> None:
    chosen = Tournament(size=9).select(np.array([[4.0], [1.0]]), 20, np.random.default_rng(0))
    assert set(chosen) == {1}


def test_a_roulette_draws_in_proportion_to_the_distance_to_the_worst() -> None:
    objectives = np.array([[-10.0], [0.0], [np.nan], [10.0]])
    chances = Roulette().chances(objectives)
    # Fitness 20 + 2, 10 + 2, 0 and 0 + 2, of 36.
    assert chances == pytest.approx([22 / 36, 12 / 36, 0.0, 2 / 36])
    drawn = Roulette().select(objectives, 9000, np.random.default_rng(0))
    assert np.bincount(drawn, minlength=4) / 9000 == pytest.approx(chances, abs=0.02)


@given(OBJECTIVES)
def test_chances_are_never_negative_and_sum_to_one(objectives: FloatArray) -> None:
    chances = Roulette().chances(objectives)
    assert (chances >= 0).all()
    assert chances.sum() == pytest.approx(1.0)
    known = np.isfinite(objectives).any(axis=1)
    if known.any():
        assert (chances[~known] == 0).all()


def test_equals_have_equal_chances() -> None:
    assert Roulette().chances(np.array([[2.0], [2.0], [np.nan]])) == pytest.approx([0.5, 0.5, 0.0])
    assert Roulette().chances(np.full((2, 1), np.nan)) == pytest.approx([0.5, 0.5])


def test_random_selection_is_without_replacement_until_exhausted() -> None:
    objectives = np.arange(5.0)[:, None]
    random = np.random.default_rng(0)
    assert sorted(RandomSelection().select(objectives, 5, random)) == [0, 1, 2, 3, 4]
    counts = np.bincount(RandomSelection().select(objectives, 12, random), minlength=5)
    assert set(counts) == {2, 3}


@given(OBJECTIVES)
def test_fronts_and_crowding_distances_are_those_of_pymoo(objectives: FloatArray) -> None:
    numbers = measurable(objectives)
    expected = NonDominatedSorting().do(numbers)
    found = fronts(objectives)
    assert [front.tolist() for front in found] == [sorted(front.tolist()) for front in expected]
    crowding = get_crowding_function("cd")
    order = []
    for front in found:
        # A value that is not measurable is worse than those of its own front.
        rooms = crowding.do(measurable(objectives[front]))
        assert crowding_distances(objectives[front]).tolist() == rooms.tolist()
        order += front[np.argsort(-rooms, kind="stable")].tolist()
    if objectives.shape[1] > 1:
        assert best_first(objectives).tolist() == order
