"""Delta debugging against brute force, with tests that are monotone and tests that are not."""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations

from hypothesis import given
from hypothesis import strategies as st

from drivora_service.suites.minimization.delta_debugging import minimal_subset

Test = Callable[[frozenset[int]], bool]


def minimised(count: int, passes: Test) -> tuple[frozenset[int], int]:
    """Answers a search by a test, one candidate after the other; also returns how many."""
    search, asked = minimal_subset(count), 0
    try:
        candidates = next(search)
        while True:
            found = None
            for number, candidate in enumerate(candidates):
                asked += 1
                if passes(candidate):
                    found = number
                    break
            candidates = search.send(found)
    except StopIteration as end:
        return end.value, asked


def is_one_minimal(kept: frozenset[int], passes: Test) -> bool:
    return not any(passes(kept - {item}) for item in kept)


@st.composite
def tables(draw: st.DrawFn) -> tuple[int, frozenset[frozenset[int]]]:
    """A number of items, and any sets of them that pass; all together do."""
    count = draw(st.integers(0, 7))
    subsets = st.frozensets(st.integers(0, max(count - 1, 0)), max_size=count)
    passing = draw(st.frozensets(subsets, max_size=40))
    return count, passing | {frozenset(range(count))}


@given(tables())
def test_the_result_passes_and_is_one_minimal_for_any_test(
    table: tuple[int, frozenset[frozenset[int]]],
) -> None:
    count, passing = table
    kept, _ = minimised(count, passing.__contains__)
    assert kept in passing
    assert is_one_minimal(kept, passing.__contains__)


@given(st.integers(1, 8), st.data())
def test_no_subset_of_the_result_passes_a_monotone_test(count: int, data: st.DataObject) -> None:
    """Brute force over all subsets: for a monotone test 1-minimal is minimal."""
    needs = data.draw(
        st.lists(st.frozensets(st.integers(0, count - 1), max_size=count), min_size=1, max_size=4)
    )

    def passes(kept: frozenset[int]) -> bool:
        return any(need <= kept for need in needs)

    kept, _ = minimised(count, lambda subset: passes(subset))
    assert passes(kept)
    for size in range(len(kept)):
        assert not any(passes(frozenset(chosen)) for chosen in combinations(kept, size))


def test_two_needed_items_of_many_take_few_tests() -> None:
    needed = frozenset({17, 800})
    kept, asked = minimised(1024, lambda subset: needed <= subset)
    assert kept == needed
    assert asked < 60


def test_nothing_is_needed() -> None:
    assert minimised(50, lambda _subset: True) == (frozenset(), 1)
    assert minimised(0, lambda _subset: False) == (frozenset(), 0)


def test_all_is_needed() -> None:
    kept, asked = minimised(8, lambda subset: len(subset) == 8)
    assert kept == frozenset(range(8))
    assert asked == 1 + 2 + 4 + 8
