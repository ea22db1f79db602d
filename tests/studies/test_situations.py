from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivora_service.oracles.verdict import Outcome, Verdict
from drivora_service.studies.situations import RADIUS, count_situations, nearest_centres


def violation(x: float, *, oracle: str = "collision", time: float = 0.0) -> Verdict:
    return Verdict(
        oracle=oracle, ego="ego_0", outcome=Outcome.VIOLATED, message="", at_fault=True, time=time,
        location=(x, 0.0),
    )  # fmt: skip


def test_alike_violations_are_one_situation_and_others_are_not() -> None:
    near, far = [violation(x) for x in (0.0, 1.0, 2.0)], [violation(x) for x in (99.0, 100.0)]
    assert count_situations([near, far, near + far, []]) == (1, 1, 2, 0)


def test_another_oracle_is_another_situation() -> None:
    assert count_situations([[violation(0.0), violation(0.0, oracle="speeding")]]) == (2,)


def test_what_fills_a_scenario_evenly_stays_apart() -> None:
    """Chains of neighbours make one group of it."""
    (many,) = count_situations([[violation(float(x)) for x in range(101)]])
    # Of three features, only x differs: 0.15 of the root mean square is 26 m of the 100.
    assert many == 4


def test_the_order_of_campaigns_does_not_matter() -> None:
    random = np.random.default_rng(5)
    found = [violation(x, time=t) for x, t in random.uniform(0.0, 100.0, (60, 2))]
    one, other = found[:30], found[30:]
    assert count_situations([one, other]) == count_situations([other, one])[::-1]
    assert count_situations([[*one, *other]]) == count_situations([[*other, *one]])
    (together,) = count_situations([found])
    assert max(count_situations([one, other])) <= together


def test_without_features_all_of_an_oracle_are_one_group() -> None:
    bare = Verdict(oracle="destination", ego="ego_0", outcome=Outcome.VIOLATED, message="")
    assert count_situations([[bare, bare], [bare]]) == (1, 1)


@given(st.lists(st.tuples(st.floats(0.0, 1.0), st.floats(0.0, 1.0)), min_size=1, max_size=40))
def test_every_violation_is_near_its_centre_and_centres_are_apart(
    places: list[tuple[float, float]],
) -> None:
    points = np.array(places)
    labels = np.array(nearest_centres(points))
    assert sorted(set(labels.tolist())) == list(range(labels.max() + 1))
    for label in range(labels.max() + 1):
        mine = points[labels == label]
        apart = np.linalg.norm(mine[:, None] - mine[None], axis=2)
        assert apart.min(axis=0).max() <= RADIUS + 1e-12
        assert apart.max() <= 2.0 * RADIUS + 1e-12


@pytest.mark.parametrize("count", [1, 2])
def test_the_same_place_is_one_centre(count: int) -> None:
    assert nearest_centres(np.zeros((count, 3))) == (0,) * count
