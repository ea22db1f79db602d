"""AVFuzzer: the contract, and every rule of the method."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from itertools import groupby
from typing import Any

import numpy as np
import pytest

from drivora_service.errors import SearchError
from drivora_service.feedback.avfuzzer import SAFETY_MARGIN, AvfuzzerFeedback
from drivora_service.feedback.measurement import Measurement
from drivora_service.geometry.array_shapes import FloatArray, IntArray
from drivora_service.search.components import Components
from drivora_service.search.distance import candidate_distances
from drivora_service.search.genes import Block, Gene, GeneKind, GeneSpace, Part
from drivora_service.search.mutation import RedrawBlock
from drivora_service.search.selection import Roulette, Truncation
from drivora_service.search.tester import (
    Evaluation,
    EvaluationStatus,
    Proposal,
    Tester,
    TesterContext,
)
from drivora_service.search.testers.avfuzzer.search import AVFUZZER, AvfuzzerParameters
from drivora_service.testing.gene_spaces import small_space
from drivora_service.testing.tester_contract import TesterContract

SPACE = small_space()
ALWAYS = {"crossover_rate": 0.0, "mutation_rate": 1.0}
"""Parameters with which every scenario of every generation changes."""

Cost = Callable[[int, Proposal], float | None]


class TestAvfuzzer(TesterContract):
    plugin = AVFUZZER
    objectives = (SAFETY_MARGIN,)

    def test_its_feedback_measures_what_it_searches_by(self) -> None:
        assert AvfuzzerFeedback().objectives == self.objectives


class TestAvfuzzerWithoutVehicles(TestAvfuzzer):
    def space(self) -> GeneSpace:
        return small_space(egos=0, vehicles=0, walkers=1)


class TestAvfuzzerOnOneBlock(TestAvfuzzer):
    def space(self) -> GeneSpace:
        return small_space(egos=0, vehicles=0, walkers=0)


def play(
    cost: Cost,
    count: int,
    *,
    seed: int = 3,
    parameters: Mapping[str, Any] | None = None,
    components: Components | None = None,
) -> list[Evaluation]:
    """Returns the first evaluations of a search with given costs of scenarios."""
    context = TesterContext(space=SPACE, random=np.random.default_rng(seed), budget=count)
    settings = replace(AvfuzzerParameters(), **(parameters or {}))
    tester: Tester = AVFUZZER.create(context, settings, components or Components())
    told: list[Evaluation] = []
    while len(told) < count:
        proposals = tester.ask(100)
        assert proposals
        for proposal in proposals:
            measured = Measurement(objectives={SAFETY_MARGIN: cost(len(told), proposal)})
            evaluation = Evaluation(
                number=len(told),
                proposal=proposal,
                status=EvaluationStatus.JUDGED,
                measurement=measured,
            )
            told.append(evaluation)
            tester.tell(evaluation)
    return told


def by_generation(*bests: float) -> Cost:
    """Returns costs by generation; later ones equal the last."""

    def cost(number: int, proposal: Proposal) -> float:
        return bests[min(proposal.generation, len(bests) - 1)]

    return cost


def generations(told: list[Evaluation]) -> list[list[Evaluation]]:
    return [list(group) for _, group in groupby(told, key=lambda e: e.proposal.generation)]


def origins(told: list[Evaluation]) -> list[str]:
    """Returns the first origin of each generation."""
    return [group[0].proposal.origin for group in generations(told)]


def random_cost(number: int, proposal: Proposal) -> float:
    return float(np.random.default_rng(number).normal())


def test_it_begins_with_four_random_scenarios() -> None:
    first = generations(play(random_cost, 40))[0]
    assert [e.proposal.origin for e in first] == ["initial"] * 4


def test_a_crossover_exchanges_one_actor_of_two_scenarios() -> None:
    told = play(
        random_cost,
        200,
        parameters={"mutation_rate": 0.0, "restart_candidates": 50, "local_mutates_all": False},
    )
    crossed = [e for e in told if e.proposal.origin == "crossover" and len(e.proposal.parents) == 2]
    assert len(crossed) > 30
    for child in crossed:
        one, other = (told[number].proposal.values for number in child.proposal.parents)
        values = child.proposal.values
        taken = [b for b in SPACE.blocks if not np.array_equal(values[b.slice], one[b.slice])]
        if len(taken) == 1:
            assert np.array_equal(values[taken[0].slice], other[taken[0].slice])
    single = [c for c in crossed if changed_blocks(c, told) == 1]
    # Both pairs of a generation may hit the same scenario, which then has two changed actors.
    assert len(single) > 0.6 * len(crossed)
    assert all(changed_blocks(c, told) <= 2 for c in crossed)


def changed_blocks(child: Evaluation, told: list[Evaluation]) -> int:
    one = told[child.proposal.parents[0]].proposal.values
    return sum(
        not np.array_equal(child.proposal.values[b.slice], one[b.slice]) for b in SPACE.blocks
    )


def test_a_mutation_changes_one_gene() -> None:
    told = play(random_cost, 300)
    mutated = [e for e in told if e.proposal.origin == "mutation"]
    assert len(mutated) > 80
    for child in mutated:
        (parent,) = child.proposal.parents
        assert np.sum(child.proposal.values != told[parent].proposal.values) == 1


@pytest.mark.parametrize("rate", [0.4, 0.8])
def test_scenarios_are_mutated_at_their_rate(rate: float) -> None:
    counts = []
    for seed in range(150):
        told = play(
            random_cost, 5, seed=seed, parameters={"crossover_rate": 0.0, "mutation_rate": rate}
        )
        counts.append(len(generations(told)[1]))
    # At least one always is.
    expected = 4 * rate + (1 - rate) ** 4
    assert np.mean(counts) == pytest.approx(expected, abs=0.3)


def test_pairs_are_crossed_at_their_rate() -> None:
    def crossed(seed: int) -> int:
        parameters = {"mutation_rate": 0.0}
        keep_all = Components(selection=KeepAll())
        told = play(random_cost, 5, seed=seed, parameters=parameters, components=keep_all)
        second = generations(told)[1]
        return sum("crossover" in e.proposal.origin for e in second)

    counts = [crossed(seed) for seed in range(200)]
    # None of two pairs with 0.6²; one with 0.48, which changes two scenarios.
    assert np.mean(np.array(counts) == 0) == pytest.approx(0.36, abs=0.08)
    assert np.mean(np.array(counts) == 2) >= 0.48 - 0.08


class KeepAll:
    """Keeps all candidates."""

    def select(self, objectives: FloatArray, count: int, random: np.random.Generator) -> IntArray:
        return np.arange(count)


def test_only_scenarios_that_changed_are_run_again() -> None:
    told = play(random_cost, 300)
    sizes = [len(group) for group in generations(told)[1:-1]]
    assert min(sizes) < 4
    assert max(sizes) <= 4
    for child in told:
        for parent in child.proposal.parents:
            assert not np.array_equal(child.proposal.values, told[parent].proposal.values)


def test_what_was_not_run_again_keeps_its_cost() -> None:
    """If the best is always chosen, only the best is a parent."""
    told = play(random_cost, 120, components=Components(selection=BestOnly()))
    best = min(told[:4], key=lambda e: measured(e))
    first, second = generations(told)[1:3]
    assert {e.proposal.parents for e in first} == {(best.number,)}
    rivals = [*first, best] if len(first) < 4 else first
    expected = min(rivals, key=lambda e: measured(e)).number
    assert {e.proposal.parents for e in second} == {(expected,)}


class BestOnly:
    """Takes the best ``count`` times."""

    def select(self, objectives: FloatArray, count: int, random: np.random.Generator) -> IntArray:
        return np.full(count, int(np.argmin(objectives[:, 0])))


def measured(evaluation: Evaluation) -> float:
    assert evaluation.measurement is not None
    value = evaluation.measurement.objectives[SAFETY_MARGIN]
    assert value is not None
    return value


def test_parents_are_drawn_by_roulette() -> None:
    costs = (0.0, 1.0, 4.0, None)
    counts = np.zeros(4)
    for seed in range(250):
        told = play(lambda number, _: costs[number % 4], 8, seed=seed, parameters=ALWAYS)
        for child in generations(told)[1]:
            counts[child.proposal.parents[0]] += 1
    chances = Roulette().chances(np.array([[0.0], [1.0], [4.0], [np.nan]]))
    assert counts / counts.sum() == pytest.approx(chances, abs=0.06)


def test_it_restarts_after_five_generations_without_improvement() -> None:
    told = play(by_generation(5.0), 80, parameters=ALWAYS)
    assert origins(told)[:14] == [
        "initial",
        *["mutation"] * 5,
        "restart",
        *["mutation"] * 5,
        "restart",
        "mutation",
    ]
    restart = generations(told)[6]
    assert len(restart) == 4
    assert all(e.proposal.parents == () for e in restart)


@pytest.mark.parametrize(("last", "restarts"), [(8.1, False), (8.2, True), (8.3, True)])
def test_it_compares_with_the_mean_of_the_last_five_bests(last: float, restarts: bool) -> None:
    told = play(by_generation(5.0, 9.0, 9.0, 9.0, 9.0, last), 28, parameters=ALWAYS)
    assert (origins(told)[6] == "restart") == restarts


def test_the_five_slide_along() -> None:
    told = play(by_generation(5.0, 9.0, 9.0, 9.0, 9.0, 8.1, 8.8), 32, parameters=ALWAYS)
    # The mean of 9, 9, 9, 9 and 8.1 is 8.82.
    assert "restart" not in origins(told)[:8]
    told = play(by_generation(5.0, 9.0, 9.0, 9.0, 9.0, 8.1, 8.83), 32, parameters=ALWAYS)
    assert origins(told)[7] == "restart"


def test_bests_of_before_a_restart_do_not_count_after_it() -> None:
    told = play(
        by_generation(*[5.0] * 6, 9.0, 8.0, 7.9, 7.8, 7.7, 7.6, 7.5),
        70,
        parameters={**ALWAYS, "local_after": 99},
    )
    assert origins(told)[6] == "restart"
    assert "restart" not in origins(told)[7:13]


def test_a_restart_is_far_from_all_past_populations() -> None:
    told = play(by_generation(5.0), 28, parameters=ALWAYS)
    past = np.array([e.proposal.values for e in told[:24]])
    drawn = SPACE.sample(np.random.default_rng(99), 2000)
    usual = candidate_distances(drawn, past, SPACE).mean(axis=1)
    fresh = np.array([e.proposal.values for e in told[24:28]])
    found = candidate_distances(fresh, past, SPACE).mean(axis=1)
    assert found.min() > np.quantile(usual, 0.98)
    assert list(found) == sorted(found, reverse=True)


def test_a_restart_draws_as_many_candidates_as_is_said() -> None:
    few = play(by_generation(5.0), 28, parameters={**ALWAYS, "restart_candidates": 4})
    fresh = np.array([e.proposal.values for e in few[24:28]])
    past = np.array([e.proposal.values for e in few[:24]])
    usual = candidate_distances(SPACE.sample(np.random.default_rng(99), 2000), past, SPACE)
    found = candidate_distances(fresh, past, SPACE).mean(axis=1)
    assert found.min() < np.quantile(usual.mean(axis=1), 0.9)


FALLING = by_generation(*np.arange(20.0, 0.0, -1.0))


def test_local_searches_start_at_the_earliest_after_two_generations() -> None:
    told = play(FALLING, 60, parameters=ALWAYS)
    expected = ["initial", *["mutation"] * 3, *["local mutation"] * 5, "mutation"]
    assert origins(told)[:10] == expected


def test_no_local_search_starts_right_after_a_restart() -> None:
    cost = by_generation(*[5.0] * 6, 4.0, 3.0, 2.0, 1.0, 0.0)
    told = play(cost, 70, parameters=ALWAYS)
    assert origins(told)[6:11] == ["restart", *["mutation"] * 3, "local mutation"]


def test_no_local_search_starts_without_a_new_best() -> None:
    told = play(by_generation(5.0, 5.0, 5.0, 5.0, 5.0, 5.0), 24, parameters=ALWAYS)
    assert not any("local" in origin for origin in origins(told))


def test_a_local_search_begins_with_copies_of_the_best_of_its_attempt() -> None:
    told = play(FALLING, 60, parameters=ALWAYS)
    third, local = generations(told)[3:5]
    assert {e.proposal.parents for e in local} == {(third[0].number,)}
    assert len(local) == 4


def test_a_local_search_first_mutates_all_its_copies() -> None:
    parameters = {"crossover_rate": 0.9, "mutation_rate": 0.1}
    for seed in range(20):
        told = play(lambda number, _: -float(number), 80, seed=seed, parameters=parameters)
        groups = generations(told)
        first = next(i for i, g in enumerate(groups) if "local" in g[0].proposal.origin)
        best = max(groups[first - 1], key=lambda e: e.number)
        copies = groups[first]
        assert [e.proposal.origin for e in copies] == ["local mutation"] * 4
        assert {e.proposal.parents for e in copies} == {(best.number,)}
        assert {np.sum(e.proposal.values != best.proposal.values) for e in copies} == {1}
        # From the second generation on it is bred: not every scenario changes.
        assert any(len(group) < 4 for group in groups[first + 1 : first + 5])


def test_a_local_search_mutates_one_and_a_half_times_as_often() -> None:
    def cost(number: int, proposal: Proposal) -> float:
        return 20.0 - proposal.generation - 0.01 * number

    counts = []
    for seed in range(150):
        told = play(
            cost, 30, seed=seed, parameters={"crossover_rate": 0.0, "local_mutates_all": False}
        )
        groups = generations(told)
        first = next(i for i, g in enumerate(groups) if "local" in g[0].proposal.origin)
        if first + 1 < len(groups):
            counts.append(len(groups[first]))
    assert np.mean(counts) == pytest.approx(4 * 0.6 + 0.4**4, abs=0.25)


@pytest.mark.parametrize(("found", "replaces"), [(-5.0, True), (30.0, False)])
def test_the_result_of_a_local_search_replaces_the_best_if_it_is_better(
    found: float, replaces: bool
) -> None:
    costs = by_generation(20.0, 19.0, 18.0, 17.0, found, 30.0, 30.0, 30.0, 30.0, 16.0)
    told = play(costs, 60, parameters=ALWAYS, components=Components(selection=BestOnly()))
    groups = generations(told)
    local, after = groups[4], groups[9]
    assert after[0].proposal.origin == "mutation"
    (parent,) = {e.proposal.parents[0] for e in after}
    assert (parent in [e.number for e in local]) == replaces
    assert replaces or parent in [e.number for e in groups[3]]


def test_the_result_of_a_local_search_starts_no_further_one() -> None:
    costs = by_generation(20.0, 19.0, 18.0, 17.0, -5.0, 30.0, 30.0, 30.0, 30.0, 16.0, 15.0)
    told = play(costs, 48, parameters=ALWAYS)
    assert origins(told)[9:11] == ["mutation", "mutation"]


def test_what_failed_is_worst() -> None:
    def cost(number: int, proposal: Proposal) -> float | None:
        return None if number % 2 else -float(number)

    told = play(cost, 120)
    for group in generations(told)[1:4]:
        assert all(parent % 2 == 0 for e in group for parent in e.proposal.parents[:1])


def test_it_takes_another_mutation_and_another_selection() -> None:
    told = play(
        random_cost, 60, components=Components(mutation=RedrawBlock(), selection=Truncation())
    )
    mutated = [e for e in told if e.proposal.origin == "mutation"]
    assert mutated
    assert all(changed_blocks(e, told) == 1 for e in mutated)
    most = [
        int(np.sum(e.proposal.values != told[e.proposal.parents[0]].proposal.values))
        for e in mutated
    ]
    assert max(most) > 1


class Nothing:
    """Changes nothing."""

    def mutate(
        self,
        values: FloatArray,
        space: GeneSpace,
        random: np.random.Generator,
        *,
        strength: float = 1.0,
    ) -> FloatArray:
        return values.copy()


def test_a_mutation_that_changes_nothing_does_not_loop_for_ever() -> None:
    nothing = Components(mutation=Nothing())
    assert len(play(random_cost, 60, parameters={"crossover_rate": 0.0}, components=nothing)) >= 60


def test_a_space_in_which_nothing_varies_is_refused() -> None:
    gene = Gene(name="green", kind=GeneKind.CONTINUOUS, low=5.0, high=5.0, unit="s")
    space = GeneSpace((Block(name="lights", part=Part.LIGHTS, start=0, genes=(gene,)),))
    context = TesterContext(space=space, random=np.random.default_rng(0), budget=10)
    with pytest.raises(SearchError, match="vary"):
        AVFUZZER.create(context, AvfuzzerParameters(), Components())
