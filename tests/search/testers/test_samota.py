"""SAMOTA as a whole: its phases, rounds and duplicates, without a simulator."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable

import numpy as np
import pytest

from drivora_service.feedback.measurement import Measurement
from drivora_service.feedback.samota import SamotaFeedback
from drivora_service.geometry.array_shapes import FloatArray, IntArray
from drivora_service.search.components import Components
from drivora_service.search.genes import Block, Gene, GeneKind, GeneSpace, Part
from drivora_service.search.tester import Evaluation, EvaluationStatus, Proposal, TesterContext
from drivora_service.search.testers.samota.encoding import Encoding
from drivora_service.search.testers.samota.parameters import SamotaParameters
from drivora_service.search.testers.samota.tester import SAMOTA, AdaptiveRandom, SamotaSearch
from drivora_service.testing.gene_spaces import small_space
from drivora_service.testing.tester_contract import TesterContract


class TestSamota(TesterContract):
    plugin = SAMOTA
    budget = 60


class TestSamotaWithItsOwnObjectives(TesterContract):
    """Six objectives; one is never measurable, and one never changes."""

    plugin = SAMOTA
    objectives = SamotaFeedback().objectives
    budget = 50

    def measure(self, unit: FloatArray) -> Measurement:
        found = dict(super().measure(unit).objectives)
        return Measurement(objectives={**found, "walker_distance": None, "red_light": 1.0})


def line(count: int, high: float = 1.0, kind: GeneKind = GeneKind.CONTINUOUS) -> GeneSpace:
    genes = tuple(Gene(name=f"x_{i}", kind=kind, low=0.0, high=high) for i in range(count))
    return GeneSpace((Block(name="all", part=Part.WEATHER, start=0, genes=genes),))


Objectives = Callable[[FloatArray], dict[str, float | None]]


class Campaign:
    """Runs a search phase by phase."""

    def __init__(
        self,
        space: GeneSpace,
        objectives: Objectives,
        components: Components | None = None,
        **parameters: float,
    ) -> None:
        context = TesterContext(space=space, random=np.random.default_rng(3), budget=1000)
        self.search = SamotaSearch(
            context,
            SamotaParameters(**parameters),  # type: ignore[arg-type]  # whole numbers as such
            components or Components(),
        )
        self._objectives = objectives
        self._script = self.search.run()
        self._open = next(self._script)
        self.told: list[Evaluation] = []

    def phase(self) -> list[Evaluation]:
        evaluations = []
        for proposal in self._open:
            evaluations.append(
                Evaluation(
                    number=len(self.told),
                    proposal=proposal,
                    status=EvaluationStatus.JUDGED,
                    measurement=Measurement(objectives=self._objectives(proposal.values)),
                )
            )
            self.told.append(evaluations[-1])
        self._open = self._script.send(tuple(evaluations))
        return evaluations


def bowl(values: FloatArray) -> dict[str, float | None]:
    return {
        "left": float(np.mean((values - 0.25) ** 2)),
        "right": float(np.mean((values - 0.75) ** 2)),
    }


def test_phases_take_turns_and_come_at_once() -> None:
    campaign = Campaign(line(4), bowl, initial=15)
    phases = [campaign.phase() for _ in range(5)]
    assert [e.proposal.origin for e in phases[0]] == ["initial"] * 15
    for k in (1, 3):
        assert Counter(e.proposal.origin for e in phases[k]) == {"best": 2, "uncertain": 2}
    for k in (2, 4):
        assert {e.proposal.origin for e in phases[k]} == {"local"}
        assert len(phases[k]) >= 2
    generations = [{e.proposal.generation for e in phase} for phase in phases]
    assert generations == [{0}, {1}, {2}, {3}, {4}]


def test_it_comes_nearer_to_every_optimum_than_random_search() -> None:
    space = line(6)
    campaign = Campaign(space, bowl)
    while len(campaign.told) < 120:
        campaign.phase()
    drawn = space.sample(np.random.default_rng(0), len(campaign.told))
    for name in ("left", "right"):
        best = campaign.search.archive.best(name)
        assert best is not None
        assert best[0] < 0.2 * min(bowl(row)[name] or 0.0 for row in drawn)


def test_a_local_candidate_stems_from_its_cluster_and_stays_in_its_bounds() -> None:
    campaign = Campaign(line(4), bowl)
    campaign.phase()
    campaign.phase()
    values = {e.number: e.proposal.values for e in campaign.told}
    for evaluation in campaign.phase():
        members = np.stack([values[number] for number in evaluation.proposal.parents])
        assert len(members) >= 5
        assert np.all(evaluation.proposal.values >= members.min(axis=0))
        assert np.all(evaluation.proposal.values <= members.max(axis=0))


def test_a_covered_objective_is_searched_no_more() -> None:
    def objectives(values: FloatArray) -> dict[str, float | None]:
        found = bowl(values)
        return {"hard": (found["left"] or 0.0) + 0.1, "easy": max((found["right"] or 0.0) - 0.3, 0)}

    campaign = Campaign(line(4), objectives)
    campaign.phase()
    assert campaign.search.archive.covered == {"easy"}
    assert Counter(e.proposal.origin for e in campaign.phase()) == {"best": 1, "uncertain": 1}
    assert campaign.search.archive.round == 0


def test_when_all_are_covered_a_new_round_begins() -> None:
    campaign = Campaign(line(4), bowl, threshold=0.5)
    campaign.phase()
    assert campaign.search.archive.round == 1
    assert {e.proposal.origin for e in campaign.phase()} == {"best", "uncertain"}


@pytest.mark.parametrize("value", [None, 0.4, 0.0])
def test_what_never_differs_cannot_be_searched(value: float | None) -> None:
    campaign = Campaign(line(4), lambda values: {**bowl(values), "always": value})
    campaign.phase()
    assert Counter(e.proposal.origin for e in campaign.phase()) == {"best": 2, "uncertain": 2}


def test_where_nothing_differs_it_explores() -> None:
    campaign = Campaign(line(4), lambda _: {"always": 0.7})
    for _ in range(4):
        assert {e.proposal.origin for e in campaign.phase()} == {"initial"}


def test_nothing_is_simulated_twice_while_there_is_something_else() -> None:
    campaign = Campaign(
        line(3, high=9.0, kind=GeneKind.INTEGER), lambda v: bowl(v / 9.0), generations=5
    )
    while len(campaign.told) < 120:
        campaign.phase()
    searched = [e.proposal for e in campaign.told if e.proposal.origin != "initial"]
    assert len(searched) > 60
    assert len({proposal.values.tobytes() for proposal in searched}) == len(searched)


def test_an_exhausted_space_is_no_end() -> None:
    campaign = Campaign(line(2, kind=GeneKind.INTEGER), bowl)
    while len(campaign.told) < 60:
        assert campaign.phase()


def test_both_ends_of_every_gene_come_up() -> None:
    def corner(values: FloatArray) -> dict[str, float | None]:
        return {"high": float(np.mean(1.0 - values)), "low": float(np.mean(values))}

    campaign = Campaign(line(4), corner, generations=10, local_generations=5)
    while len(campaign.told) < 100:
        campaign.phase()
    values = np.stack([e.proposal.values for e in campaign.told])
    assert np.all(values.max(axis=0) == 1.0)
    assert np.all(values.min(axis=0) == 0.0)


class _Calls:
    """A mutation and a selection that count their calls."""

    def __init__(self) -> None:
        self.mutations = self.selections = 0

    def mutate(
        self,
        values: FloatArray,
        space: GeneSpace,
        random: np.random.Generator,
        *,
        strength: float = 1.0,
    ) -> FloatArray:
        self.mutations += 1
        return space.clip(values + 0.01 * strength * random.standard_normal(len(space)))

    def select(self, objectives: FloatArray, count: int, random: np.random.Generator) -> IntArray:
        self.selections += 1
        return np.argsort(objectives.sum(axis=1))[:count]


def test_its_parts_can_be_replaced() -> None:
    calls = _Calls()
    campaign = Campaign(line(4), bowl, Components(mutation=calls, selection=calls), generations=5)
    campaign.phase()
    campaign.phase()
    assert calls.selections == 5
    assert calls.mutations >= 5 * 50


class TestAdaptiveRandom:
    def test_its_candidates_are_farther_apart_than_random_ones(self) -> None:
        space = line(2)
        adaptive = AdaptiveRandom(space, pool=10)
        random = np.random.default_rng(1)
        spread = np.stack([adaptive.draw(random) for _ in range(20)])
        plain = [space.sample(random, 20) for _ in range(20)]
        assert _nearest(spread) > np.mean([_nearest(points) for points in plain]) * 1.5

    def test_a_pool_of_one_is_random_testing(self) -> None:
        space = line(2)
        adaptive, random = AdaptiveRandom(space, pool=1), np.random.default_rng(1)
        drawn = np.stack([adaptive.draw(random) for _ in range(5)])
        assert np.array_equal(drawn, space.sample(np.random.default_rng(1), 5))


def _nearest(points: FloatArray) -> float:
    apart = np.linalg.norm(points[:, None] - points[None], axis=2)
    np.fill_diagonal(apart, np.inf)
    return float(apart.min(axis=1).mean())


class TestEncoding:
    def test_magnitudes_reach_both_ends_and_categories_are_equally_far_apart(self) -> None:
        space = small_space()
        model = space.blocks[3].index("model")
        rows = np.stack([space.lows] * 4)
        rows[:, space.blocks[3].start] = 1.0
        rows[:, model] = range(4)
        features = Encoding(space).encode(rows)
        apart = np.linalg.norm(features[:, None] - features[None], axis=2)
        assert np.allclose(apart[~np.eye(4, dtype=bool)], 1.0)
        both = Encoding(space).encode(np.stack((space.lows, space.highs)))
        assert both.min() == 0.0
        assert both.max() == 1.0

    def test_two_scenarios_without_an_actor_are_alike_whatever_its_genes(self) -> None:
        space = small_space()
        block = space.blocks[3]
        assert block.is_optional
        one, other = space.sample(np.random.default_rng(1), 2)
        other[: block.start], other[block.stop :] = one[: block.start], one[block.stop :]
        one[block.start] = other[block.start] = 1.0
        apart = Encoding(space).encode(np.stack((one, other)))
        assert not np.array_equal(*apart)
        one[block.start] = other[block.start] = 0.0
        assert np.array_equal(*Encoding(space).encode(np.stack((one, other))))

    def test_genes_that_do_not_vary_are_left_out(self) -> None:
        space = small_space()
        categories = [int(g.high) + 1 for g in space.genes if g.kind is GeneKind.CATEGORY]
        fixed = int(np.sum(~space.varies))
        assert fixed
        expected = len(space) - fixed - len(categories) + sum(categories)
        assert Encoding(space).encode(space.sample(np.random.default_rng(0), 2)).shape == (
            2,
            expected,
        )


def test_it_learns_from_repaired_candidates_and_from_judged_ones_only() -> None:
    context = TesterContext(space=line(2), random=np.random.default_rng(3), budget=100)
    search = SamotaSearch(context, SamotaParameters(initial=12), Components())
    script = search.run()
    told = []
    for number, proposal in enumerate(next(script)):
        repaired = np.round(proposal.values, 1)
        judged = number % 3 > 0
        told.append(
            Evaluation(
                number=number,
                proposal=Proposal(values=repaired, origin=proposal.origin),
                status=EvaluationStatus.JUDGED if judged else EvaluationStatus.FAILED,
                measurement=Measurement(objectives=bowl(repaired)) if judged else None,
            )
        )
    script.send(tuple(told))
    assert search.database.numbers == [n for n in range(12) if n % 3 > 0]
    assert np.array_equal(search.database.values, np.round(search.database.values, 1))
