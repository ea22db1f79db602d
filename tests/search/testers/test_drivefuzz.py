"""DriveFuzz: cycles of mutants, of which the worst driven one is the next parent."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from drivora_service.errors import SearchError
from drivora_service.feedback.drivefuzz import QUALITY
from drivora_service.feedback.measurement import Measurement
from drivora_service.oracles.verdict import Outcome, Verdict
from drivora_service.search.components import Components
from drivora_service.search.genes import GeneSpace, Part
from drivora_service.search.mutation import RedrawGene
from drivora_service.search.tester import (
    Evaluation,
    EvaluationStatus,
    Proposal,
    Tester,
    TesterContext,
)
from drivora_service.search.testers.drivefuzz.tester import DRIVEFUZZ, DrivefuzzParameters
from drivora_service.testing.gene_spaces import small_space
from drivora_service.testing.tester_contract import TesterContract

SPACE = small_space(egos=0, patches=2)
ADDED = (Part.VEHICLE, Part.WALKER, Part.OBSTACLE, Part.PATCH)
VIOLATED = Verdict(
    oracle="collision", ego="ego", outcome=Outcome.VIOLATED, message="", at_fault=True, time=1.0
)


class TestDriveFuzz(TesterContract):
    plugin = DRIVEFUZZ
    objectives = (QUALITY,)


class TestDriveFuzzWithPatches(TesterContract):
    plugin = DRIVEFUZZ
    objectives = (QUALITY,)

    def space(self) -> GeneSpace:
        return SPACE


def create(
    seed: int = 5, space: GeneSpace = SPACE, components: Components | None = None, **parameters: Any
) -> Tester:
    context = TesterContext(space=space, random=np.random.default_rng(seed), budget=400)
    return DRIVEFUZZ.create(context, DrivefuzzParameters(**parameters), components or Components())


def judged(number: int, proposal: Proposal, quality: float | None) -> Evaluation:
    return Evaluation(
        number=number,
        proposal=proposal,
        status=EvaluationStatus.JUDGED,
        measurement=Measurement(objectives={QUALITY: quality}),
    )


def play(
    tester: Tester, count: int, evaluate: Callable[[int, Proposal], Evaluation]
) -> list[Evaluation]:
    told: list[Evaluation] = []
    while len(told) < count:
        for proposal in tester.ask(count - len(told)):
            evaluation = evaluate(len(told), proposal)
            tester.tell(evaluation)
            told.append(evaluation)
    return told


def by_luck(number: int, proposal: Proposal) -> Evaluation:
    return judged(number, proposal, -float(np.random.default_rng(number).integers(1000)))


def added(values: np.ndarray) -> int:
    """Number of actors and patches that are there."""
    return int(sum(values[b.start] for b in SPACE.blocks if b.part in ADDED))


def changed(one: np.ndarray, other: np.ndarray) -> set[str]:
    return {b.name for b in SPACE.blocks if not np.array_equal(one[b.slice], other[b.slice])}


def test_the_paper_runs_ten_cycles_of_eight_mutants() -> None:
    told = play(create(), 240, by_luck)
    for number, one in enumerate(told):
        assert one.proposal.generation == number // 8
        seedless = number % 80 < 8
        assert bool(one.proposal.parents) is not seedless


def test_the_worst_driven_mutant_is_the_parent_of_the_next_cycle() -> None:
    told = play(create(), 80, by_luck)
    for cycle in range(1, 10):
        before = told[8 * (cycle - 1) : 8 * cycle]
        worst = min(before, key=lambda e: e.measurement.objectives[QUALITY])  # type: ignore[union-attr, return-value, arg-type]  # all are measured
        for mutant in told[8 * cycle : 8 * (cycle + 1)]:
            assert mutant.proposal.parents == (worst.number,)


def test_each_mutant_has_one_thing_more_than_its_parent() -> None:
    told = play(create(), 240, by_luck)
    kinds = set()
    for mutant in told:
        if not mutant.proposal.parents:
            assert added(mutant.proposal.values) <= 1
            continue
        parent = told[mutant.proposal.parents[0]].proposal.values
        (name,) = changed(parent, mutant.proposal.values) or {""}
        part = mutant.proposal.origin.partition(" ")[0]
        assert name.startswith(part)
        kinds.add(part)
        more = added(mutant.proposal.values) - added(parent)
        assert more == (part != "weather") or all(
            parent[b.start] == 1.0 for b in SPACE.of(Part(part))
        )
    assert kinds == {"vehicle", "walker", "patch", "weather"}


def test_a_violation_ends_the_seed_after_its_cycle() -> None:
    def evaluate(number: int, proposal: Proposal) -> Evaluation:
        found = judged(number, proposal, -1.0)
        return replace(found, violations=(VIOLATED,)) if number == 18 else found

    told = play(create(), 40, evaluate)
    assert all(one.proposal.parents for one in told[8:24])
    assert not any(one.proposal.parents for one in told[24:32])
    assert all(added(one.proposal.values) <= 1 for one in told[24:32])
    assert all(one.proposal.parents for one in told[32:40])


def test_a_seed_is_calm_and_clear_and_has_nothing_added() -> None:
    told = play(create(patch_chance=1.0, weather_chance=0.0), 8, by_luck)
    (weather,) = SPACE.of(Part.WEATHER)
    for one in told:
        assert one.proposal.origin == "patch added"
        assert added(one.proposal.values) == 1
        assert one.proposal.values[weather.slice].tolist() == [0.0] * len(weather.genes)


def test_a_cycle_without_any_measure_leaves_the_parent() -> None:
    def evaluate(number: int, proposal: Proposal) -> Evaluation:
        return judged(number, proposal, None if 8 <= number < 16 else -float(number))

    told = play(create(), 24, evaluate)
    assert {one.proposal.parents for one in told[16:]} == {(7,)}


def test_a_mutation_and_a_selection_replace_its_own() -> None:
    class Last:
        def select(self, objectives: np.ndarray, count: int, random: Any) -> np.ndarray:
            return np.array([len(objectives) - 1])

    components = Components(mutation=RedrawGene(), selection=Last())
    told = play(create(components=components), 16, by_luck)
    assert {one.proposal.origin for one in told} == {"mutation"}
    assert {one.proposal.parents for one in told[8:]} == {(7,)}
    assert all(
        np.count_nonzero(one.proposal.values != told[7].proposal.values) == 1 for one in told[8:]
    )


def test_other_feedback_is_refused() -> None:
    tester = create(mutants=1)
    (proposal,) = tester.ask(1)
    found = Evaluation(
        number=0,
        proposal=proposal,
        status=EvaluationStatus.JUDGED,
        measurement=Measurement(objectives={"min_gap": 0.2}),
    )
    tester.tell(found)
    with pytest.raises(SearchError, match="driving_quality"):
        tester.ask(1)


def test_a_space_in_which_nothing_may_be_absent_is_refused() -> None:
    space = small_space(egos=0, vehicles=0, walkers=0)
    with pytest.raises(SearchError, match="optional: true"):
        create(space=space)


def test_distances_in_the_wrong_order_are_refused() -> None:
    with pytest.raises(SearchError, match="nearest"):
        create(nearest=40.0, farthest=5.0)
