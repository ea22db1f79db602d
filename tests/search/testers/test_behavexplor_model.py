"""Label sequences, their distance, and their clusters."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.search.testers.behavexplor import behaviour_model
from drivora_service.search.testers.behavexplor.behaviour_model import (
    BehaviourModel,
    sequence_distances,
)

Labels = list[int]
SEQUENCES = st.lists(st.integers(0, 3), max_size=12)


def distance(one: Labels, other: Labels) -> float:
    (found,) = sequence_distances(
        np.array(one, int), np.array([other], int), np.array([len(other)])
    )
    return float(found)


def behaviour(word: str, noise: float = 0.0, seed: int = 0) -> FloatArray:
    """A run whose windows are the letters of a word: alike for alike letters, far for others."""
    random = np.random.default_rng(seed)
    rows = np.zeros((len(word), 26))
    lit = [ord(letter) - ord("a") for letter in word]
    rows[np.arange(len(word)), lit] = 10.0 + noise * random.standard_normal(len(word))
    return rows


def model(fewest: int = 10, most: int = 20, seed: int = 0) -> BehaviourModel:
    return BehaviourModel(fewest=fewest, most=most, random=np.random.default_rng(seed))


@pytest.mark.parametrize(
    ("one", "other", "expected"),
    [
        ([1, 2, 3], [1, 2, 3], 0.0),
        ([1, 2, 3], [1, 0, 3], 1 / 3),
        ([1, 2, 3, 3], [1, 2], 0.5),
        ([1], [0, 1, 1, 1], 1.0),
        ([0, 0], [0, 0, 0, 0, 0, 1, 1, 1], 0.75),
        ([], [1, 2], 1.0),
        ([], [], 0.0),
    ],
)
def test_distances_worked_out_by_hand(one: Labels, other: Labels, expected: float) -> None:
    assert distance(one, other) == pytest.approx(expected)


@given(SEQUENCES, st.lists(SEQUENCES, min_size=1, max_size=5))
def test_distances_to_many_are_those_to_each(one: Labels, others: list[Labels]) -> None:
    lengths = np.array([len(other) for other in others])
    table = np.full((len(others), lengths.max()), -1)
    for row, other in zip(table, others, strict=True):
        row[: len(other)] = other
    expected = [
        (sum(a != b for a, b in zip(one, other, strict=False)) + abs(len(one) - len(other)))
        / max(len(one), len(other), 1)
        for other in others
    ]
    found = sequence_distances(np.array(one, int), table, lengths)
    np.testing.assert_allclose(found, expected)


@given(SEQUENCES, SEQUENCES)
def test_distances_have_no_direction(one: Labels, other: Labels) -> None:
    assert distance(one, other) == distance(other, one)


def test_everything_is_new_to_an_empty_archive() -> None:
    assert model().novelty(behaviour("abc")) == 1.0


def test_novelty_is_the_distance_to_the_nearest() -> None:
    known = model()
    known.extend([behaviour("aabbcc"), behaviour("ccddee")])
    assert known.novelty(behaviour("aabbcc")) == 0.0
    assert known.novelty(behaviour("aabbcd")) == pytest.approx(1 / 6)
    assert known.novelty(behaviour("aabb")) == pytest.approx(2 / 6)
    assert known.novelty(behaviour("bbaacc", noise=0.1)) == pytest.approx(4 / 6)
    assert known.novelty(behaviour("eeeaaa")) == 1.0


def test_what_was_archived_is_known_and_older_runs_stay_so() -> None:
    known = model()
    known.extend([behaviour("aaaa")])
    for word in ("bbbb", "ccccc", "abab", "dc", "eeeeeeee"):
        known.extend([behaviour(word, noise=0.2)])
        assert known.novelty(behaviour(word, noise=0.2)) == 0.0
        assert known.novelty(behaviour("aaaa")) == 0.0
    assert known.archived == known.fits == 6


def test_a_behaviour_that_had_no_label_gets_one_by_the_refit() -> None:
    known = model()
    known.extend([behaviour("ab" * 8, noise=0.1)])
    one, other = behaviour("c" * 16), behaviour("d" * 16)
    assert known.labels(one)[0] == known.labels(other)[0]
    known.extend([one])
    known.extend([other])
    assert len({int(known.labels(run)[0]) for run in (one, other)}) == 2


def test_all_statistics_count_alike_whatever_their_units() -> None:
    random = np.random.default_rng(0)
    level = random.integers(2, size=400)
    loud = random.standard_normal(400) * 1000.0
    known = model(fewest=2, most=2)
    table = np.stack([loud, level * 0.01, level * 0.02], axis=1)
    known.extend([table])
    agreement = float(np.mean(known.labels(table) == level))
    assert max(agreement, 1.0 - agreement) == 1.0


def test_rounding_errors_make_no_clusters() -> None:
    random = np.random.default_rng(0)
    level = random.integers(2, size=400)
    errors = 1e-5 * random.standard_normal((400, 20))
    known = model(fewest=2, most=2)
    table = np.column_stack([errors, level * 1.0])
    known.extend([table])
    agreement = float(np.mean(known.labels(table) == level))
    assert max(agreement, 1.0 - agreement) == 1.0


@pytest.mark.parametrize("letters", [11, 14, 18])
def test_the_number_of_clusters_fits_the_behaviours(letters: int) -> None:
    word = "".join(chr(ord("a") + i) for i in range(letters)) * 6
    known = model()
    known.extend([behaviour(word, noise=0.3)])
    assert known.clusters == letters


def test_the_number_of_clusters_stays_within_its_bounds() -> None:
    random = np.random.default_rng(0)
    known = model(fewest=10, most=12)
    for _ in range(8):
        known.extend([random.standard_normal((20, 64))])
        assert 10 <= known.clusters <= 12


def test_the_number_is_chosen_anew_when_the_archive_has_doubled() -> None:
    known = model()
    known.extend([behaviour("abcdefghijk" * 4, noise=0.3)])
    assert known.clusters == 11
    known.extend([behaviour("lmnopq", noise=0.3)])
    assert known.clusters == 11
    known.extend([behaviour("lmnopq" * 12, noise=0.3)])
    assert known.clusters == 17


def test_a_refit_in_between_does_not_forget() -> None:
    run = behaviour("abcdefghijkl" * 6, noise=0.3)
    known = model()
    known.extend([run])
    known.extend([behaviour("aabbccddeeff", noise=0.3, seed=1)])
    assert len(np.unique(known.labels(run))) == known.clusters == 12


@pytest.mark.parametrize("word", ["a", "ab", "aaaaaaaaaaaaaaaaaaaaaaaaaaaaaa", "abababababababab"])
def test_behaviours_fewer_than_clusters_are_no_obstacle(word: str) -> None:
    known = model()
    known.extend([behaviour(word)])
    assert known.novelty(behaviour(word)) == 0.0
    known.extend([behaviour("z")])
    assert known.novelty(behaviour("z")) == 0.0


def test_large_archives_are_fitted_to_a_sample_but_labelled_as_a_whole(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(behaviour_model, "FIT_ROWS", 60)
    known = model()
    words = ["abcdefghijkl", "lkjihgfedcba", "aabbccddeeff"]
    for k in range(12):
        known.extend([behaviour(words[k % 3] * 2, noise=0.2, seed=k)])
    for word in words:
        assert known.novelty(behaviour(word * 2, noise=0.2, seed=99)) == 0.0


def test_the_same_seed_gives_the_same_labels() -> None:
    random = np.random.default_rng(3)
    runs = [random.standard_normal((30, 64)) for _ in range(12)]
    labels = []
    for _ in range(2):
        known = model(seed=4)
        for run in runs:
            known.extend([run])
        labels.append(known.labels(np.concatenate(runs)))
    first, second = labels
    np.testing.assert_array_equal(first, second)
