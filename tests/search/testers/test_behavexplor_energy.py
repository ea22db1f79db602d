"""The energy of seeds, against values worked out by hand."""

from __future__ import annotations

from math import tanh

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivora_service.search.testers.behavexplor.energy import (
    EnergySelection,
    Seed,
    initial_energy,
)


def seed(energy: float = 1.0) -> Seed:
    return Seed(
        number=0,
        values=np.zeros(1),
        without_effect=np.zeros(1, dtype=np.bool_),
        degree=0.5,
        energy=energy,
    )


@pytest.mark.parametrize(
    ("gain", "novelty", "expected"),
    [(0.5, 0.5, 1.5), (0.0, 0.0, 1.0), (-0.4, 0.6, 1.1), (1.0, 1.0, 2.0), (-1.0, 0.0, 0.5)],
)
def test_a_seed_starts_with_its_gain_and_its_novelty(
    gain: float, novelty: float, expected: float
) -> None:
    assert initial_energy(gain, novelty) == pytest.approx(expected)


def test_a_successful_mutant_adds_the_success_rate() -> None:
    parent = seed()
    parent.learn(is_success=True, gain=0.0, novelty=0.0)
    assert parent.energy == pytest.approx(1.0 + 0.5 * 1.0 - 0.05)
    parent.learn(is_success=False, gain=0.0, novelty=0.0)
    assert parent.energy == pytest.approx(1.45 + 0.5 * (-0.1 * 0.5) - 0.05)
    parent.learn(is_success=True, gain=0.0, novelty=0.0)
    assert parent.energy == pytest.approx(1.375 + 0.5 * 2.0 / 3.0 - 0.05)


def test_the_gain_counts_more_the_newer_the_behaviour() -> None:
    plain, new = seed(), seed()
    plain.learn(is_success=False, gain=0.2, novelty=0.0)
    new.learn(is_success=False, gain=0.2, novelty=0.75)
    assert plain.energy == pytest.approx(1.0 - 0.05 + 0.5 * tanh(0.2) - 0.05)
    assert new.energy == pytest.approx(1.0 - 0.05 + 0.5 * tanh(0.8) - 0.05)


@pytest.mark.parametrize(("gain", "slope"), [(0.01, 1.0), (0.0, 0.0), (-0.01, -1.0)])
def test_an_entirely_new_behaviour_makes_any_gain_count_fully(gain: float, slope: float) -> None:
    parent = seed()
    parent.learn(is_success=True, gain=gain, novelty=1.0)
    assert parent.energy == pytest.approx(1.0 + 0.5 + 0.5 * slope - 0.05)


def test_failed_and_worse_mutants_reduce_the_energy_to_zero() -> None:
    parent = seed()
    energies = []
    for _ in range(20):
        parent.learn(is_success=False, gain=-0.1, novelty=0.1)
        energies.append(parent.energy)
    assert energies == sorted(energies, reverse=True)
    assert energies[-1] == 0.0


@given(st.lists(st.tuples(st.booleans(), st.floats(-1.0, 1.0), st.floats(0.0, 1.0)), max_size=30))
def test_energies_are_never_negative(told: list[tuple[bool, float, float]]) -> None:
    parent = seed()
    for is_success, gain, novelty in told:
        parent.learn(is_success=is_success, gain=gain, novelty=novelty)
        assert np.isfinite(parent.energy)
        assert parent.energy >= 0.0


def test_seeds_are_drawn_in_proportion_to_their_energy() -> None:
    energies = np.array([[1.0], [0.0], [3.0]])
    drawn = EnergySelection().select(-energies, 20000, np.random.default_rng(1))
    shares = np.bincount(drawn, minlength=3) / len(drawn)
    np.testing.assert_allclose(shares, [0.25, 0.0, 0.75], atol=0.02)


def test_where_no_energy_is_left_all_are_drawn_alike() -> None:
    drawn = EnergySelection().select(np.zeros((4, 1)), 8000, np.random.default_rng(1))
    np.testing.assert_allclose(np.bincount(drawn) / len(drawn), 0.25, atol=0.03)
