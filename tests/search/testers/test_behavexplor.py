"""BehAVExplor: the order of proposals, the corpus, and the effects of evaluations."""

from __future__ import annotations

import re
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drivora_service.errors import SearchError
from drivora_service.feedback.behavexplor import DEGREE, WINDOWS, BehavexplorFeedback
from drivora_service.feedback.measurement import Measurement
from drivora_service.geometry.array_shapes import FloatArray, IntArray
from drivora_service.oracles.verdict import Outcome, Verdict
from drivora_service.search.components import Components
from drivora_service.search.genes import Block, Gene, GeneKind, GeneSpace, Part
from drivora_service.search.tester import (
    Evaluation,
    EvaluationStatus,
    Proposal,
    TesterContext,
)
from drivora_service.search.testers.behavexplor.energy import Seed
from drivora_service.search.testers.behavexplor.tester import (
    BEHAVEXPLOR,
    BehavexplorParameters,
    BehavexplorTester,
    Failures,
)
from drivora_service.testing.gene_spaces import small_space
from drivora_service.testing.tester_contract import TesterContract

SPACE = small_space()
CRASH = Verdict(
    oracle="collision", ego="ego_0", outcome=Outcome.VIOLATED, message="", at_fault=True, time=1.0
)


def run_of(word: str) -> tuple[tuple[float, ...], ...]:
    """The windows of a run: alike for alike letters, far from each other for others."""
    return tuple(tuple(10.0 * (letter == other) for other in "abcdefgh") for letter in word)


class TestBehavexplor(TesterContract):
    """The contract of testers."""

    plugin = BEHAVEXPLOR
    objectives = (DEGREE,)

    def measure(self, unit: FloatArray) -> Measurement:
        """A sort of behaviour every second, which the genes choose."""
        found = super().measure(unit)
        letters = ["abcdefgh"[int(7.999 * share)] for share in unit[: 8 + int(20 * unit[0])]]
        return Measurement(
            objectives=found.objectives, features={WINDOWS: run_of("".join(letters))}
        )


class Play:
    """Asks a tester and tells it given evaluations."""

    def __init__(
        self,
        parameters: BehavexplorParameters | None = None,
        components: Components | None = None,
        space: GeneSpace = SPACE,
    ) -> None:
        context = TesterContext(space=space, random=np.random.default_rng(3), budget=100)
        tester = BEHAVEXPLOR.create(
            context, parameters or BehavexplorParameters(), components or Components()
        )
        assert isinstance(tester, BehavexplorTester)
        self.tester = tester
        self.asked: list[Proposal] = []
        self.told = 0

    def ask(self, room: int = 1) -> tuple[Proposal, ...]:
        proposals = self.tester.ask(room)
        self.asked += proposals
        return proposals

    def tell(self, word: str = "aaaa", degree: float | None = 0.5, **others: Any) -> None:
        given: dict[str, Any] = {
            "status": EvaluationStatus.JUDGED,
            "measurement": Measurement(
                objectives={DEGREE: degree}, features={WINDOWS: run_of(word)}
            ),
            **others,
        }
        self.tester.tell(Evaluation(number=self.told, proposal=self.asked[self.told], **given))
        self.told += 1

    def begin(self, *words: str, degree: float = 0.5) -> list[Seed]:
        """Tells the first candidates; returns the corpus."""
        self.ask(len(words))
        for word in words:
            self.tell(word, degree)
        return self.tester.corpus


def begun(*words: str, **parameters: Any) -> Play:
    words = words or ("aaaa",)
    play = Play(BehavexplorParameters(initial=len(words), **parameters))
    play.begin(*words)
    return play


def test_it_begins_with_so_many_drawn_candidates_and_waits_for_all() -> None:
    play = Play()
    assert [p.origin for p in play.ask(3)] == ["initial"] * 3
    assert [p.origin for p in play.ask(3)] == ["initial"]
    for _ in range(3):
        assert play.ask(3) == ()
        play.tell()
    assert play.ask(3) == ()
    play.tell()
    bred = play.ask(3)
    assert [p.origin for p in bred] == ["mutation"] * 3
    assert {p.parents for p in bred} <= {(0,), (1,), (2,), (3,)}


def test_the_first_seeds_have_the_energy_of_the_code() -> None:
    seeds = begun("aaaa", "bbbb").tester.corpus
    assert [(seed.number, seed.energy) for seed in seeds] == [(0, 1.5), (1, 1.5)]


def test_the_first_candidates_make_the_model() -> None:
    play = begun("aaaa", "bbbb")
    assert (play.tester.model.archived, play.tester.model.fits) == (2, 1)


def test_the_repaired_candidate_is_what_is_bred_from() -> None:
    play = Play(BehavexplorParameters(initial=1))
    play.ask()
    repaired = SPACE.sample(np.random.default_rng(9))
    play.asked[0] = Proposal(values=repaired, origin="initial")
    play.tell()
    np.testing.assert_array_equal(play.tester.corpus[0].values, repaired)
    whole = SPACE.is_whole
    (child,) = play.ask()
    np.testing.assert_array_equal(child.values[whole], repaired[whole])


def test_where_all_of_the_first_fail_more_are_drawn_until_one_does_not() -> None:
    play = Play(BehavexplorParameters(initial=2))
    play.ask(2)
    play.tell(violations=(CRASH,))
    play.tell(violations=(CRASH,))
    assert [p.origin for p in play.ask(3)] == ["initial"] * 3
    play.tell(violations=(CRASH,))
    assert play.tester.corpus == []
    play.tell("aaaa")
    assert [seed.number for seed in play.tester.corpus] == [3]
    assert play.ask()[0].origin == "mutation"
    play.tell("bbbb")
    assert [seed.number for seed in play.tester.corpus] == [3, 4]
    assert play.tester.model.archived == 2


@pytest.mark.parametrize(
    ("word", "degree", "is_kept", "is_archived"),
    [
        ("aaaaaaaaaa", 0.5, False, False),
        ("aaaaaaaaaa", 0.6, False, False),
        ("aaaaaaaaaa", 0.4, True, False),
        ("bbbbbaaaaa", 0.6, True, True),
        ("bbbbaaaaaa", 0.6, False, False),
        ("bbbbbbbbbb", 0.4, True, True),
        ("aaaaaaaaaabbbbbbb", 0.6, True, True),
        ("aaaaaaaaaabbbbbb", 0.6, False, False),
    ],
)
def test_a_child_that_is_new_or_nearer_to_a_failure_is_kept(
    word: str, degree: float, is_kept: bool, is_archived: bool
) -> None:
    play = begun("aaaaaaaaaa", "bbbbbbbbbbbbbbbbbbbbbbbbbbbbbb")
    play.ask()
    play.tell(word, degree)
    assert [seed.number for seed in play.tester.corpus] == [0, 1, 2][: 2 + is_kept]
    assert play.tester.model.archived == play.tester.model.fits + 1 == 2 + is_archived


def test_what_was_new_is_known_from_then_on() -> None:
    play = begun("aaaaaaaa", "bbbbbbbbbbbbbbbbbbbbbbbbbbbbbb")
    for _ in range(2):
        play.ask()
        play.tell("abababab")
    assert [seed.number for seed in play.tester.corpus] == [0, 1, 2]


def test_the_threshold_of_novelty_is_a_parameter() -> None:
    play = begun("aaaaaaaaaa", "bbbbbbbbbbbbbbbbbbbb", novelty=0.2)
    play.ask()
    play.tell("bbbaaaaaaa", 0.6)
    assert play.tester.model.archived == 3


def test_a_kept_child_starts_with_its_gain_and_novelty() -> None:
    play = begun("aaaaaaaaaa", "bbbbbbbbbbbbbbbbbbbb")
    play.ask()
    play.tell("bbbbbaaaaa", 0.3)
    seed = play.tester.corpus[-1]
    assert (seed.number, seed.degree) == (2, 0.3)
    assert seed.energy == pytest.approx(1.0 + 0.5 * (0.2 + 0.5))


def test_an_evaluation_changes_the_energy_of_the_parent_alone() -> None:
    play = begun("aaaa", "aaaa", "aaaa")
    (child,) = play.ask()
    play.tell("aaaa", 0.5)
    expected = dict.fromkeys(range(3), 1.5)
    expected[child.parents[0]] = 1.5 - 0.5 * 0.1 - 0.05
    assert {seed.number: seed.energy for seed in play.tester.corpus} == pytest.approx(expected)


def test_a_failure_rewards_the_parent_but_is_not_bred_from() -> None:
    play = begun()
    play.ask()
    play.tell("bbbb", 0.0, violations=(CRASH,))
    (parent,) = play.tester.corpus
    assert (parent.children, parent.successes) == (1, 1)
    assert parent.energy > 1.5
    assert play.tester.model.archived == 1


def verdict(oracle: str, **fields: Any) -> Verdict:
    given = {"outcome": Outcome.VIOLATED, "message": "", "time": 1.0, **fields}
    return Verdict(oracle=oracle, ego="ego_0", **given)


HIT_BY_ANOTHER = verdict("collision", at_fault=False)
NOT_ARRIVED = verdict("destination", evidence={"reason": "timeout"})


@pytest.mark.parametrize("why", [HIT_BY_ANOTHER, NOT_ARRIVED], ids=["hit", "not arrived"])
@pytest.mark.parametrize("failures", list(Failures))
def test_hits_by_anothers_fault_and_egos_that_do_not_arrive_are_no_seeds(
    why: Verdict, failures: Failures
) -> None:
    play = begun(failures=failures)
    play.ask()
    play.tell("bbbb", 0.0, verdicts=(verdict("speeding"), why))
    (parent,) = play.tester.corpus
    assert play.tester.model.archived == 1
    play.ask()
    play.tell("aaaa", 0.0, verdicts=(why,))
    assert (parent.children, parent.successes) == (2, 2 if failures is Failures.EVERY else 0)
    assert play.tester.corpus == [parent]


@pytest.mark.parametrize("why", [HIT_BY_ANOTHER, NOT_ARRIVED], ids=["hit", "not arrived"])
def test_drawn_candidates_are_barred_alike(why: Verdict) -> None:
    play = Play(BehavexplorParameters(initial=1))
    play.ask()
    play.tell(verdicts=(why,))
    assert play.tester.corpus == []
    assert [p.origin for p in play.ask(2)] == ["initial"] * 2


@pytest.mark.parametrize(
    "passed",
    [
        verdict("destination", evidence={"reason": "late"}),
        verdict("collision", outcome=Outcome.PASSED),
        verdict("destination", outcome=Outcome.NOT_MEASURABLE),
        verdict("speeding", at_fault=True),
    ],
    ids=["late", "no collision", "not started", "another oracle"],
)
def test_nothing_else_bars_a_candidate(passed: Verdict) -> None:
    play = begun()
    play.ask()
    play.tell("aaaa", 0.4, verdicts=(passed,))
    assert [seed.number for seed in play.tester.corpus] == [0, 1]


def test_failures_are_bred_from_on_demand() -> None:
    play = begun(breed_failures=True)
    play.ask()
    play.tell("aaaa", 0.0, violations=(CRASH,))
    assert [seed.number for seed in play.tester.corpus] == [0, 1]


def test_a_seed_with_little_energy_is_redrawn_and_pays_for_it() -> None:
    play = begun()
    (seed,) = play.tester.corpus
    seed.energy = 0.5
    (child,) = play.ask()
    assert (child.origin, child.parents) == ("redraw", (0,))
    assert not np.array_equal(child.values[SPACE.is_whole], seed.values[SPACE.is_whole])
    play.tell("aaaa", 0.6)
    assert seed.energy == pytest.approx(0.4)
    assert seed.children == 0


def test_energy_above_the_bound_means_noise() -> None:
    play = begun()
    (seed,) = play.tester.corpus
    seed.energy = 0.51
    (child,) = play.ask()
    assert child.origin == "mutation"
    np.testing.assert_array_equal(child.values[SPACE.is_whole], seed.values[SPACE.is_whole])


def test_what_a_child_was_made_by_is_decided_when_it_is_asked() -> None:
    play = begun()
    (seed,) = play.tester.corpus
    seed.energy = 0.51
    play.ask(2)
    seed.energy = 0.4
    play.tell("aaaa", 0.5)
    assert seed.children == 1


def test_asking_for_several_does_not_change_the_corpus() -> None:
    play = begun("aaaa", "bbbb")
    before = [seed.energy for seed in play.tester.corpus]
    assert len(play.ask(8)) == 8
    assert [seed.energy for seed in play.tester.corpus] == before


def test_a_seed_without_energy_is_not_drawn_while_others_have_some() -> None:
    play = begun("aaaa", "bbbb")
    play.tester.corpus[0].energy = 0.0
    assert {p.parents for p in play.ask(40)} == {(1,)}
    play.tester.corpus[1].energy = 0.0
    assert {p.parents for p in play.ask(40)} == {(0,), (1,)}


@pytest.mark.parametrize(
    "told",
    [
        {"status": EvaluationStatus.INVALID, "measurement": None},
        {"status": EvaluationStatus.FAILED, "measurement": None},
        {"measurement": Measurement(objectives={DEGREE: None}, features={WINDOWS: ()})},
    ],
)
def test_what_shows_no_behaviour_is_not_kept_and_costs_energy(told: dict[str, Any]) -> None:
    play = begun()
    play.ask()
    play.tell(**told)
    (parent,) = play.tester.corpus
    assert (parent.children, parent.successes) == (1, 0)
    assert parent.energy < 1.5


def test_what_is_not_measurable_counts_as_farthest_from_a_failure() -> None:
    play = begun("aaaa", "bbbbbbbbbb")
    play.ask()
    play.tell("bbbb", None)
    assert len(play.tester.corpus) == 3
    assert play.tester.corpus[-1].degree == 1.0


def test_generations_count_the_fits_of_the_model() -> None:
    play = begun("aaaa", "bbbbbbbbbb")
    assert play.asked[0].generation == 0
    assert play.ask()[0].generation == 1
    play.tell("abab")
    assert play.ask()[0].generation == 2


def test_another_mutation_and_selection_can_take_their_place() -> None:
    class Last:
        def select(
            self, objectives: FloatArray, count: int, random: np.random.Generator
        ) -> IntArray:
            self.objectives = objectives
            return np.full(count, len(objectives) - 1)

    class Lows:
        def mutate(
            self,
            values: FloatArray,
            space: GeneSpace,
            random: np.random.Generator,
            *,
            strength: float = 1.0,
        ) -> FloatArray:
            return space.lows.copy()

    last = Last()
    play = Play(BehavexplorParameters(initial=2), Components(mutation=Lows(), selection=last))
    play.begin("aaaa", "bbbb")
    for proposal in play.ask(3):
        assert proposal.parents == (1,)
        np.testing.assert_array_equal(proposal.values, SPACE.lows)
    np.testing.assert_array_equal(last.objectives, [[-1.5], [-1.5]])


def test_another_feedback_is_refused() -> None:
    play = Play()
    play.ask()
    with pytest.raises(SearchError, match="feedback 'behavexplor'"):
        play.tell(measurement=Measurement(objectives={"min_gap": 0.3}))


@pytest.mark.parametrize(
    "parts", [{"vehicles": 0}, {"egos": 0, "walkers": 0}, {"vehicles": 0, "walkers": 0}]
)
def test_it_works_without_some_of_the_parts(parts: dict[str, int]) -> None:
    play = Play(space=small_space(**parts))
    play.begin("aaaa", "bbbb", "cccc", "dddd")
    for proposal in play.ask(20):
        parent = play.asked[proposal.parents[0]]
        assert not np.array_equal(proposal.values, parent.values)


def test_a_space_without_magnitudes_is_refused() -> None:
    gene = Gene(name="model", kind=GeneKind.CATEGORY, low=0.0, high=3.0)
    block = Block(name="vehicle_0", part=Part.VEHICLE, start=0, genes=(gene,))
    with pytest.raises(SearchError, match="magnitude"):
        Play(space=GeneSpace((block,)))


def test_bounds_of_clusters_out_of_order_are_refused() -> None:
    with pytest.raises(SearchError, match="fewest_clusters is 12"):
        Play(BehavexplorParameters(fewest_clusters=12, most_clusters=11))


@pytest.mark.parametrize(
    ("section", "owner"),
    [("## Parameters", BehavexplorParameters()), ("## The feedback", BehavexplorFeedback())],
)
def test_the_reference_tells_every_parameter_and_its_default(
    repository: Path, section: str, owner: BehavexplorParameters | BehavexplorFeedback
) -> None:
    page = repository / "docs" / "reference" / "testers" / "behavexplor.md"
    text = page.read_text(encoding="utf-8").split(section)[1].split("\n## ")[0]
    documented = dict(re.findall(r"^\| `(\w+)` \| ([^ |]+) ", text, re.MULTILINE))
    defaults = {field.name: getattr(owner, field.name) for field in fields(owner)}
    assert documented == {name: _shown(value) for name, value in defaults.items()}


def _shown(value: float | bool | str) -> str:
    return str(value).lower() if isinstance(value, bool | str) else f"{value:.4g}"
