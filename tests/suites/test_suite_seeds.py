"""The seeds of a suite's runs."""

from __future__ import annotations

from drivora_service.scenario.fields import MAX_SEED
from drivora_service.suites.suite_seeds import seed_of_run

NAMES = [f"scenario-{number}" for number in range(100)]


def test_the_first_run_has_the_scenarios_own_seed() -> None:
    assert {seed_of_run(name, 7, 0, given=None) for name in NAMES} == {7}


def test_further_runs_of_one_scenario_have_different_seeds() -> None:
    seeds = [seed_of_run("a", 7, repetition, given=None) for repetition in range(50)]
    assert len(set(seeds)) == 50


def test_scenarios_do_not_share_seeds() -> None:
    for given in (None, 0, 3):
        seeds = [
            seed_of_run(name, 0, repetition, given=given)
            for name in NAMES
            for repetition in range(1, 6)
        ]
        assert len(set(seeds)) == len(seeds)


def test_another_number_gives_other_seeds_which_are_allowed() -> None:
    seeds = {seed_of_run("a", 7, 0, given=given) for given in (0, 1, MAX_SEED)}
    assert len(seeds) == 3
    assert all(0 <= seed <= MAX_SEED for seed in seeds)
    assert seed_of_run("a", 7, 0, given=5) == seed_of_run("a", 8, 0, given=5)
