"""LawBreaker: the contract, and every rule of the method."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import groupby
from typing import Any

import numpy as np
import pytest

from drivora_service.errors import SearchError
from drivora_service.feedback.measurement import Measurement
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.search.components import Components
from drivora_service.search.genes import Block, Gene, GeneKind, GeneSpace, Part
from drivora_service.search.tester import Evaluation, EvaluationStatus, Proposal, TesterContext
from drivora_service.search.testers.lawbreaker.archive import Archive
from drivora_service.search.testers.lawbreaker.search import (
    LAWBREAKER,
    LawbreakerParameters,
    LawbreakerSearch,
)
from drivora_service.testing.gene_spaces import small_space
from drivora_service.testing.tester_contract import TesterContract

SPACE = small_space()
FIRST = int(np.flatnonzero(SPACE.varies & ~SPACE.is_whole)[0])
"""A magnitude that varies."""

Costs = Callable[[FloatArray], Mapping[str, float | None]]


class TestLawbreaker(TesterContract):
    plugin = LAWBREAKER
    objectives = ("speed/1", "speed/2", "light/1")

    def feedback_objectives(self) -> tuple[str, ...]:
        return self.objectives


class TestLawbreakerWithFewGenes(TestLawbreaker):
    def space(self) -> GeneSpace:
        return small_space(egos=0, vehicles=0, walkers=1)


def evaluation(number: int, proposal: Proposal, costs: Mapping[str, float | None]) -> Evaluation:
    return Evaluation(
        number=number,
        proposal=proposal,
        status=EvaluationStatus.JUDGED,
        measurement=Measurement(objectives=costs),
    )


def play(
    costs: Costs, count: int, *, failed: frozenset[int] = frozenset(), **parameters: Any
) -> tuple[list[Evaluation], LawbreakerSearch]:
    """Evaluates candidates one by one; the costs are those of values as shares of the ranges."""
    context = TesterContext(space=SPACE, random=np.random.default_rng(3), budget=count)
    search = LawbreakerSearch(context, LawbreakerParameters(**parameters), Components())
    script = search.script()
    told: list[Evaluation] = []
    proposals = next(script)
    while True:
        generation = []
        for proposal in proposals:
            number = len(told)
            if number in failed:
                one = Evaluation(number=number, proposal=proposal, status=EvaluationStatus.FAILED)
            else:
                one = evaluation(number, proposal, costs(SPACE.to_unit(proposal.values)))
            told.append(one)
            generation.append(one)
            if len(told) == count:
                return told, search
        proposals = script.send(tuple(generation))


def far(unit: FloatArray) -> Mapping[str, float | None]:
    """One violation that is nearer the smaller a gene is, and is never covered."""
    return {"speed/1": 0.1 + 0.5 * float(unit[FIRST])}


def test_the_nearest_scenario_of_every_uncovered_violation_is_kept() -> None:
    archive = Archive(())
    proposals = [Proposal(values=np.array([float(k)]), origin="initial") for k in range(4)]
    costs: list[Mapping[str, float | None]] = [
        {"speed/1": 0.5, "light/1": 0.2},
        {"speed/1": 0.3, "light/1": 0.2},
        {"speed/1": 0.4, "light/1": -0.1},
        {"speed/1": 0.9, "light/1": 0.1},
    ]
    for number, (proposal, cost) in enumerate(zip(proposals, costs, strict=True)):
        one = archive.individual(evaluation(number, proposal, cost))
        assert one is not None
        archive.add(one)
        if number == 1:
            assert {name: kept.number for name, kept in archive.nearest.items()} == {
                "speed/1": 1,
                "light/1": 0,
            }
    # Covered by the third, and retired: the fourth, which is near, is not kept for it.
    assert archive.covered == {"light/1"}
    assert {name: kept.number for name, kept in archive.nearest.items()} == {"speed/1": 1}


def test_exactly_zero_covers_nothing() -> None:
    archive = Archive(())
    one = archive.individual(
        evaluation(0, Proposal(values=np.zeros(1), origin="initial"), {"speed/1": 0.0})
    )
    assert one is not None
    archive.add(one)
    assert not archive.covered
    assert archive.nearest["speed/1"].number == 0


def test_only_chosen_laws_count() -> None:
    archive = Archive(("light",))
    proposal = Proposal(values=np.zeros(1), origin="initial")
    one = archive.individual(evaluation(0, proposal, {"speed/1": 0.1, "light/1": 0.2}))
    assert one is not None
    assert dict(one.costs) == {"light/1": 0.2}
    assert archive.individual(evaluation(1, proposal, {"speed/1": 0.1})) is None
    assert archive.individual(evaluation(2, proposal, {"light/1": None})) is None


def test_every_generation_is_bred_from_the_nearest_scenarios() -> None:
    told, _ = play(far, 100)
    costs = [float(far(SPACE.to_unit(one.proposal.values))["speed/1"] or 0.0) for one in told]
    for one in told[20:]:
        begun = one.number - one.number % 20
        assert one.proposal.parents[0] == int(np.argmin(costs[:begun]))


def test_the_kept_scenario_is_never_lost_or_run_again() -> None:
    told, search = play(far, 200)
    best = min(told, key=lambda one: one.measurement.objectives["speed/1"])  # type: ignore[union-attr,arg-type,return-value]  # all are measured
    assert search.archive.nearest["speed/1"].number <= best.number
    for one in told[20:]:
        parents = [told[number].proposal.values for number in one.proposal.parents]
        assert not any(np.array_equal(one.proposal.values, parent) for parent in parents)


def test_uncovered_violations_take_turns() -> None:
    def two(unit: FloatArray) -> Mapping[str, float | None]:
        return {"a/1": 0.1 + float(unit[FIRST]) / 2, "b/1": 0.6 - float(unit[FIRST]) / 2}

    told, _ = play(two, 40)
    parents = [one.proposal.parents[0] for one in told[20:]]
    assert sorted(parents.count(parent) for parent in set(parents)) == [10, 10]


def test_a_violation_that_nothing_is_near_to_guides_no_child() -> None:
    def one_flat(unit: FloatArray) -> Mapping[str, float | None]:
        return {"flat/1": 1.0, **far(unit)}

    told, search = play(one_flat, 60)
    nearest = {name: kept.number for name, kept in search.archive.nearest.items()}
    assert nearest["flat/1"] == 0
    assert all(one.proposal.parents[0] != 0 for one in told[20:40])
    only_flat, _ = play(lambda _: {"flat/1": 1.0}, 60)
    assert all(one.proposal.parents[0] == 0 for one in only_flat[20:])


def test_a_population_is_drawn_anew_after_the_generations() -> None:
    told, _ = play(far, 130, generations=3)
    origins = [key for key, _ in groupby(told, key=lambda one: one.proposal.origin == "restart")]
    assert origins == [False, True, False, True]
    restarts = [one for one in told if one.proposal.origin == "restart"]
    assert {one.proposal.generation for one in restarts} == {3, 6}
    assert [one.number for one in restarts][:20] == list(range(60, 80))


def test_when_everything_is_covered_populations_are_drawn() -> None:
    told, search = play(lambda _: {"speed/1": -0.5}, 60)
    assert [one.proposal.origin for one in told] == ["initial"] * 20 + ["restart"] * 40
    assert search.archive.covered == {"speed/1"}


def test_failed_runs_are_no_parents() -> None:
    told, _ = play(far, 60, failed=frozenset(range(0, 60, 3)))
    assert all(number % 3 for one in told for number in one.proposal.parents)
    none, _ = play(far, 60, failed=frozenset(range(60)))
    assert {one.proposal.origin for one in none} == {"initial", "restart"}


def test_without_crossover_children_are_mutants_of_one_parent() -> None:
    told, _ = play(far, 60, crossover_rate=0.0, mutation_rate=0.0)
    assert {one.proposal.origin for one in told[20:]} == {"mutation"}
    assert {len(one.proposal.parents) for one in told[20:]} == {1}


def test_without_mutation_children_have_genes_of_two_parents() -> None:
    told, _ = play(far, 60, crossover_rate=1.0, mutation_rate=0.0)
    crossed = [one for one in told[20:] if one.proposal.origin == "crossover"]
    assert crossed
    for one in crossed:
        first, second = (told[number].proposal.values for number in one.proposal.parents)
        values = one.proposal.values
        assert np.all((values == first) | (values == second))


def test_it_comes_nearer_than_random_draws() -> None:
    told, _ = play(far, 200)
    bred = [float(SPACE.to_unit(one.proposal.values)[FIRST]) for one in told]
    assert min(bred) < 0.01
    assert np.median(bred[100:]) < 0.2


def test_a_space_without_genes_that_vary_is_refused() -> None:
    gene = Gene(name="green", kind=GeneKind.CONTINUOUS, low=5.0, high=5.0, unit="s")
    fixed = GeneSpace((Block(name="lights", part=Part.LIGHTS, start=0, genes=(gene,)),))
    context = TesterContext(space=fixed, random=np.random.default_rng(0), budget=10)
    with pytest.raises(SearchError, match="needs a gene that varies"):
        LAWBREAKER.create(context, LawbreakerParameters(), Components())
