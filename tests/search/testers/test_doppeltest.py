"""DoppelTest: the contract of testers, survival, and new violations."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from drivora_service.errors import SearchError
from drivora_service.feedback.doppeltest import DOPPELTEST as FEEDBACK
from drivora_service.feedback.measurement import Measurement
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.oracles.verdict import Outcome, Verdict
from drivora_service.search.components import Components
from drivora_service.search.genes import GeneSpace, Part
from drivora_service.search.mutation import RedrawGene
from drivora_service.search.selection import RandomSelection
from drivora_service.search.tester import Evaluation, EvaluationStatus, Proposal, TesterContext
from drivora_service.search.testers.doppeltest.chromosome import Chromosome
from drivora_service.search.testers.doppeltest.parameters import DoppelTestParameters
from drivora_service.search.testers.doppeltest.tester import DOPPELTEST, DoppelTest
from drivora_service.search.testers.doppeltest.violations import ViolationLog
from drivora_service.testing.gene_spaces import small_space
from drivora_service.testing.tester_contract import TesterContract

SPACE = small_space(egos=5)
OBJECTIVES = FEEDBACK.create({}).objectives


def context(space: GeneSpace = SPACE, seed: int = 7, **more: Any) -> TesterContext:
    return TesterContext(space=space, random=np.random.default_rng(seed), budget=200, **more)


def evaluated(
    number: int,
    proposal: Proposal,
    objectives: tuple[float | None, ...],
    violations: tuple[Verdict, ...] = (),
) -> Evaluation:
    return Evaluation(
        number=number,
        proposal=proposal,
        status=EvaluationStatus.JUDGED,
        violations=violations,
        measurement=Measurement(objectives=dict(zip(OBJECTIVES, objectives, strict=True))),
    )


def violated(oracle: str, ego: str, counterpart: str = "", **evidence: Any) -> Verdict:
    return Verdict(
        oracle=oracle,
        ego=ego,
        outcome=Outcome.VIOLATED,
        message="",
        counterpart=counterpart,
        evidence=evidence,
    )


class TestDoppelTest(TesterContract):
    """The contract of testers."""

    plugin = DOPPELTEST
    objectives = OBJECTIVES

    def test_generations_are_of_ten_and_told_before_the_next(self) -> None:
        tester = self.create()
        assert len(tester.ask(4)) == 4
        rest = tester.ask(100)
        assert len(rest) == 6
        assert tester.ask(100) == ()

    def test_children_have_parents_of_earlier_generations(self) -> None:
        told = self.play(self.create(), self.budget, 4)
        generation = {e.number: e.proposal.generation for e in told}
        for evaluation in told:
            proposal = evaluation.proposal
            expected = {"initial": 0, "crossover": 2, "mutation": 1}[proposal.origin]
            assert len(set(proposal.parents)) == expected
            assert all(generation[parent] < proposal.generation for parent in proposal.parents)

    def test_four_of_five_children_have_two_parents(self) -> None:
        told = self.play(self.create(), 1_000, 10)
        origins = Counter(e.proposal.origin for e in told)
        share = origins["crossover"] / (origins["crossover"] + origins["mutation"])
        assert origins["initial"] == 10
        assert share == pytest.approx(0.8, abs=0.05)

    def test_nothing_is_proposed_twice(self) -> None:
        told = self.play(self.create(), 500, 10)
        assert len({e.proposal.values.tobytes() for e in told}) == 500

    def test_what_no_section_holds_is_inherited(self) -> None:
        space = self.space()
        told = self.play(self.create(), self.budget, 4)
        kept = [block.slice for block in space.blocks if block.part in (Part.VEHICLE, Part.WEATHER)]
        for evaluation in told:
            values = evaluation.proposal.values
            for parent in evaluation.proposal.parents[:1]:
                for part in kept:
                    assert np.array_equal(values[part], told[parent].proposal.values[part])


def play_generation(
    method: DoppelTest, objectives: list[tuple[float | None, ...]]
) -> tuple[list[int], tuple[Proposal, ...]]:
    """Evaluates the seeds; returns the numbers of the survivors of all, and the children."""
    script = method.script()
    seeds = next(script)
    children = script.send(tuple(evaluated(i, seed, objectives[i]) for i, seed in enumerate(seeds)))
    grown = script.send(
        tuple(
            evaluated(len(seeds) + i, child, objectives[len(seeds) + i])
            for i, child in enumerate(children)
        )
    )
    return [individual.number for individual in method.population], grown


def test_the_best_of_parents_and_children_survive() -> None:
    small = DoppelTestParameters(population=4, offspring=4)
    method = DoppelTest(context(), small, Components())
    order = [(3.0,), (9.0,), (1.0,), (8.0,), (0.0,), (7.0,), (2.0,), (6.0,)]
    survivors, grown = play_generation(method, [(distance, 0.0, 0.0) for (distance,) in order])
    assert sorted(survivors) == [0, 2, 4, 6]
    assert {parent for child in grown for parent in child.parents} <= {0, 2, 4, 6}


def test_the_best_of_any_objective_survives() -> None:
    small = DoppelTestParameters(population=3, offspring=3)
    method = DoppelTest(context(), small, Components())
    survivors, _ = play_generation(
        method,
        [
            (5.0, 0.0, 0.0),
            (9.0, -4.0, 0.0),
            (9.0, 0.0, -3.0),
            (6.0, 0.0, 0.0),
            (9.0, -1.0, 0.0),
            (9.0, 0.0, -1.0),
        ],
    )
    assert sorted(survivors) == [0, 1, 2]


def test_a_new_violation_lets_survive_and_a_known_one_does_not() -> None:
    small = DoppelTestParameters(population=2, offspring=2, crossover=0.0)
    method = DoppelTest(context(), small, Components())
    script = method.script()
    seeds = next(script)
    values = seeds[0].values
    twin = replace(seeds[1], values=values)
    crash = violated("collision", "ego_0", "ego_1")
    script.send(
        (
            evaluated(0, seeds[0], (1.0, 0.0, 0.0), (crash,)),
            evaluated(1, twin, (1.0, 0.0, 0.0), (crash,)),
        )
    )
    assert [individual.objectives[-1] for individual in method.population] == [-1.0, 0.0]


def test_what_is_not_measurable_is_worst() -> None:
    small = DoppelTestParameters(population=2, offspring=2)
    method = DoppelTest(context(), small, Components())
    survivors, _ = play_generation(
        method, [(None, 0.0, 0.0), (99.0, 0.0, 0.0), (98.0, 0.0, 0.0), (None, 0.0, 0.0)]
    )
    assert sorted(survivors) == [1, 2]


def test_a_candidate_that_was_not_judged_is_no_parent() -> None:
    method = DoppelTest(context(), DoppelTestParameters(), Components())
    script = method.script()
    seeds = next(script)
    evaluations = tuple(
        evaluated(i, seed, (1.0, 0.0, 0.0))
        if i < 3
        else Evaluation(number=i, proposal=seed, status=EvaluationStatus.INVALID)
        for i, seed in enumerate(seeds)
    )
    children = script.send(evaluations)
    assert {parent for child in children for parent in child.parents} <= {0, 1, 2}


def test_seeds_are_drawn_until_there_are_two() -> None:
    method = DoppelTest(context(), DoppelTestParameters(), Components())
    script = method.script()
    seeds = next(script)
    failed = tuple(
        Evaluation(number=i, proposal=seed, status=EvaluationStatus.FAILED)
        for i, seed in enumerate(seeds)
    )
    again = script.send(failed)
    assert {(proposal.origin, proposal.generation) for proposal in again} == {("initial", 1)}


def test_the_genes_that_were_run_are_those_that_are_bred() -> None:
    small = DoppelTestParameters(population=2, offspring=20, crossover=0.0)
    method = DoppelTest(context(), small, Components())
    script = method.script()
    seeds = next(script)
    repaired = [seed.values.copy() for seed in seeds]
    weather = SPACE.of(Part.WEATHER)[0].slice
    for values in repaired:
        values[weather] = 50.0
    children = script.send(
        tuple(
            evaluated(i, replace(seed, values=values), (1.0, 0.0, 0.0))
            for i, (seed, values) in enumerate(zip(seeds, repaired, strict=True))
        )
    )
    assert all((child.values[weather] == 50.0).all() for child in children)


def test_components_take_the_place_of_its_own() -> None:
    weather = SPACE.of(Part.WEATHER)[0].slice

    def grown(components: Components) -> tuple[DoppelTest, tuple[Proposal, ...], list[Proposal]]:
        parameters = DoppelTestParameters(population=4, offspring=40, crossover=0.0)
        method = DoppelTest(context(), parameters, components)
        script = method.script()
        seeds = next(script)
        told = tuple(evaluated(i, seed, (float(i), 0.0, 0.0)) for i, seed in enumerate(seeds))
        children = script.send(told)
        script.send(tuple(evaluated(4 + i, c, (9.0 + i, 0.0, 0.0)) for i, c in enumerate(children)))
        return method, children, list(seeds)

    def changed_weather(children: tuple[Proposal, ...], seeds: list[Proposal]) -> bool:
        return any(
            not np.array_equal(c.values[weather], seeds[c.parents[0]].values[weather])
            for c in children
        )

    method, children, seeds = grown(Components())
    assert not changed_weather(children, seeds)
    assert {individual.number for individual in method.population} == {0, 1, 2, 3}
    method, children, seeds = grown(Components(mutation=RedrawGene(), selection=RandomSelection()))
    assert changed_weather(children, seeds)
    assert {individual.number for individual in method.population} != {0, 1, 2, 3}


@pytest.mark.parametrize("egos", [0, 1])
def test_it_needs_two_egos(egos: int) -> None:
    with pytest.raises(SearchError, match=r"set `space.egos` to 2..5"):
        DOPPELTEST.create(context(small_space(egos=egos)), DoppelTestParameters(), Components())


def test_it_needs_a_conflict() -> None:
    nowhere = context(conflicts=np.zeros((6, 6), dtype=np.bool_))
    with pytest.raises(SearchError, match=r"no two of the 6 paths .* conflict"):
        DOPPELTEST.create(nowhere, DoppelTestParameters(), Components())
    other = context(conflicts=~np.eye(4, dtype=np.bool_))
    with pytest.raises(SearchError, match=r"\(4, 4\) paths are given.* choose from 6"):
        DOPPELTEST.create(other, DoppelTestParameters(), Components())


def test_rates_that_exceed_1_are_refused() -> None:
    with pytest.raises(SearchError, match=r"remove_ego = 0.8 and add_ego = 0.3 exceed 1"):
        DOPPELTEST.create(context(), DoppelTestParameters(remove_ego=0.8), Components())


def test_it_works_without_walkers_lights_and_the_rest() -> None:
    egos = tuple(block for block in small_space(vehicles=0, walkers=0).blocks if block.start < 12)
    bare = GeneSpace(egos)
    tester = DOPPELTEST.create(context(bare), DoppelTestParameters(), Components())
    for number in range(100):
        (proposal,) = tester.ask(1)
        assert bare.within(proposal.values)
        tester.tell(evaluated(number, proposal, (1.0, 0.0, 0.0)))


LOG_VALUES = SPACE.lows.copy()


def at_paths(*paths: int, walker: int = 0) -> FloatArray:
    """Returns genes of egos on paths, and of a first walker that crosses an ego's path."""
    values = LOG_VALUES.copy()
    for block, path in zip(SPACE.of(Part.EGO), paths, strict=False):
        values[block.index("path")] = path
    values[SPACE.of(Part.WALKER)[0].index("path")] = walker
    return values


def news(*found: tuple[FloatArray, Verdict]) -> list[int]:
    """Counts the new violations of candidates that are told one after the other."""
    log = ViolationLog(Chromosome(SPACE, None))
    return [
        log.count_new(
            evaluated(i, Proposal(values=values, origin="initial"), (0.0, 0.0, 0.0), (verdict,))
        )
        for i, (values, verdict) in enumerate(found)
    ]


def test_the_same_violation_on_the_same_routes_is_not_new() -> None:
    assert news(
        (at_paths(1, 2, 3), violated("collision", "ego_0", "ego_1")),
        (at_paths(5, 2, 1), violated("collision", "ego_1", "ego_2")),
        (at_paths(5, 2, 1), violated("collision", "ego_0", "ego_2")),
    ) == [1, 0, 1]


def test_another_oracle_is_a_new_violation_on_the_same_route() -> None:
    assert news(
        (at_paths(1), violated("red_light", "ego_0")),
        (at_paths(1), violated("speeding", "ego_0")),
        (at_paths(2, 1), violated("red_light", "ego_1")),
        (at_paths(2), violated("red_light", "ego_0")),
    ) == [1, 1, 0, 1]


def test_a_walker_is_known_by_the_route_that_it_crosses() -> None:
    assert news(
        (at_paths(1, 2, walker=0), violated("collision", "ego_0", "walker_0")),
        (at_paths(2, 1, walker=1), violated("collision", "ego_1", "walker_0")),
        (at_paths(1, 2, walker=1), violated("collision", "ego_0", "walker_0")),
        (at_paths(1, 1), violated("collision", "ego_0", "ego_1")),
        # Two egos are there: the third of them is the first.
        (at_paths(1, 2, walker=2), violated("collision", "ego_0", "walker_0")),
    ) == [1, 0, 1, 1, 0]


def test_both_verdicts_of_one_collision_are_one_violation() -> None:
    log = ViolationLog(Chromosome(SPACE, None))
    both = (violated("collision", "ego_0", "ego_1"), violated("collision", "ego_1", "ego_0"))
    proposal = Proposal(values=at_paths(1, 2), origin="initial")
    assert log.count_new(evaluated(0, proposal, (0.0, 0.0, 0.0), both)) == 1


def test_a_deadlock_is_one_violation_of_all_its_egos() -> None:
    log = ViolationLog(Chromosome(SPACE, None))
    cycle = ["ego_0", "ego_1", "ego_2"]
    verdicts = tuple(
        violated("deadlock", cycle[i], cycle[(i + 1) % 3], cycle=cycle) for i in range(3)
    )
    proposal = Proposal(values=at_paths(1, 2, 3), origin="initial")
    assert log.count_new(evaluated(0, proposal, (0.0, 0.0, 0.0), verdicts)) == 1


def test_routes_are_told_apart_of_egos_that_are_called_otherwise() -> None:
    renamed = {f"ego_{i}": name for i, name in enumerate(("mine", "ego_2", "ego_2.1"))}
    blocks = tuple(replace(b, actor=renamed.get(b.name, b.actor)) for b in SPACE.blocks)
    log = ViolationLog(Chromosome(GeneSpace(blocks), None))
    first, other = at_paths(1, 2, 3), at_paths(1, 2, 4)
    for ego, new in (("mine", False), ("ego_2", False), ("ego_2.1", True)):
        identities = {log.identity(violated("red_light", ego), values) for values in (first, other)}
        assert (len(identities) == 2) == new


def test_actors_that_no_gene_stands_for_are_alike() -> None:
    assert news(
        (at_paths(1), violated("collision", "ego_0", "background_7")),
        (at_paths(1), violated("collision", "ego_0", "background_8")),
        (at_paths(1), violated("collision", "ego_0", "vehicle_1")),
    ) == [1, 0, 1]
