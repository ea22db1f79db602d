"""The contract of testers, as a suite of tests for authors of testers.

Derive a class whose name begins with ``Test`` and give it the plug-in::

    class TestMyTester(TesterContract):
        plugin = MY_PLUGIN

A tester whose feedback measures features overrides :meth:`TesterContract.measure`.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import replace
from typing import Any, ClassVar

import numpy as np
import pytest

from drivora_service.campaigns.search.warm_start import ORIGIN, WarmStart
from drivora_service.errors import SearchError
from drivora_service.feedback.catalogue import FeedbackCatalogue
from drivora_service.feedback.measurement import Measurement
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.oracles.verdict import Outcome, Verdict
from drivora_service.parameters import describe_parameters
from drivora_service.runs.adversary import AdversarySource
from drivora_service.search.aims import Aim, Guidance
from drivora_service.search.budget_bounds import problems_of_tester
from drivora_service.search.components import Components
from drivora_service.search.genes import GeneSpace
from drivora_service.search.plugin import TesterPlugin
from drivora_service.search.tester import (
    Evaluation,
    EvaluationStatus,
    Proposal,
    Tester,
    TesterContext,
)
from drivora_service.testing.gene_spaces import small_space


class TesterContract:
    """Tests that every tester passes.

    Attributes:
        plugin: The tester under test.
        objectives: Names of the objectives that are measured; empty: those of its feedback.
        budget: Evaluations of the longer tests.
    """

    # Because of its name, pytest would collect it wherever it is imported.
    __test__ = False

    plugin: ClassVar[TesterPlugin[Any]]
    objectives: ClassVar[tuple[str, ...]] = ()
    budget: ClassVar[int] = 150

    def __init_subclass__(cls) -> None:
        """Marks derived classes as suites."""
        super().__init_subclass__()
        cls.__test__ = True

    def space(self) -> GeneSpace:
        """Returns the space to search."""
        return small_space()

    def measure(self, unit: FloatArray) -> Measurement:
        """Measures a candidate, given as (d,) values in 0..1, without a simulator."""
        names = self.objectives or self.feedback_objectives()
        return Measurement(
            objectives={
                name: float(np.mean(np.abs(unit[i :: len(names)] - 0.3)))
                for i, name in enumerate(names)
            }
        )

    def feedback_objectives(self) -> tuple[str, ...]:
        """Returns the names of all objectives that its feedback measures."""
        return tuple(FeedbackCatalogue().create(self.plugin.feedback).objectives)

    def create(self, seed: int = 7, aims: tuple[Aim, ...] = ()) -> Tester:
        """Makes the tester with its default parameters.

        Args:
            seed: Seed of its random draws.
            aims: Objectives that a campaign chose.
        """
        context = TesterContext(
            space=self.space(), random=np.random.default_rng(seed), budget=self.budget, aims=aims
        )
        return self.plugin.create(context, self.plugin.parameters(), Components())

    def judged(self, number: int, proposal: Proposal) -> Evaluation:
        """Evaluates a proposal: about one in twenty fails."""
        space = self.space()
        measurement = self.measure(space.to_unit(proposal.values))
        worst = min((v for v in measurement.objectives.values() if v is not None), default=1.0)
        verdict = Verdict(
            oracle="collision",
            ego="ego_0",
            outcome=Outcome.VIOLATED,
            message="",
            at_fault=True,
            time=1.0,
        )
        return Evaluation(
            number=number,
            proposal=proposal,
            status=EvaluationStatus.JUDGED,
            violations=(verdict,) if worst < 0.12 else (),
            verdicts=(verdict,) if worst < 0.12 else (),
            scores=dict(measurement.objectives),
            measurement=measurement,
        )

    def play(
        self,
        tester: Tester,
        count: int,
        window: int,
        evaluate: Callable[[int, Proposal], Evaluation] | None = None,
    ) -> list[Evaluation]:
        """Asks and tells like an engine, with at most ``window`` proposals under way."""
        evaluate = evaluate or self.judged
        told: list[Evaluation] = []
        waiting: deque[tuple[int, Proposal]] = deque()
        asked = 0
        while len(told) < count:
            room = min(window - len(waiting), count - asked)
            if room > 0:
                proposals = tester.ask(room)
                assert len(proposals) <= room
                for proposal in proposals:
                    waiting.append((asked, proposal))
                    asked += 1
            assert waiting, "nothing is proposed although everything has been told"
            number, proposal = waiting.popleft()
            evaluation = evaluate(number, proposal)
            tester.tell(evaluation)
            told.append(evaluation)
        return told

    def test_it_goes_on_until_the_budget_is_spent(self) -> None:
        assert len(self.play(self.create(), self.budget, 4)) == self.budget

    def test_its_candidates_are_within_the_bounds(self) -> None:
        space = self.space()
        for evaluation in self.play(self.create(), self.budget, 4):
            assert space.within(evaluation.proposal.values)

    def test_the_same_seed_gives_the_same_candidates(self) -> None:
        one = self.play(self.create(), self.budget, 3)
        other = self.play(self.create(), self.budget, 3)
        assert [_key(e.proposal) for e in one] == [_key(e.proposal) for e in other]

    def test_another_seed_gives_other_candidates(self) -> None:
        one = self.play(self.create(1), 20, 3)
        other = self.play(self.create(2), 20, 3)
        assert [_key(e.proposal) for e in one] != [_key(e.proposal) for e in other]

    def test_it_leaves_its_candidates_as_they_were(self) -> None:
        values: list[FloatArray] = []

        def note(number: int, proposal: Proposal) -> Evaluation:
            values.append(proposal.values.copy())
            return self.judged(number, proposal)

        told = self.play(self.create(), 60, 3, note)
        assert all(
            np.array_equal(kept, e.proposal.values) for kept, e in zip(values, told, strict=True)
        )

    def test_parents_are_evaluations_that_were_told(self) -> None:
        told = self.play(self.create(), self.budget, 4)
        assert all(parent < e.number for e in told for parent in e.proposal.parents)

    def test_generations_never_go_back(self) -> None:
        generations = [e.proposal.generation for e in self.play(self.create(), self.budget, 4)]
        assert generations == sorted(generations)

    def test_it_goes_on_where_nothing_can_be_judged(self) -> None:
        def fail(number: int, proposal: Proposal) -> Evaluation:
            return Evaluation(number=number, proposal=proposal, status=EvaluationStatus.FAILED)

        assert len(self.play(self.create(), 60, 4, fail)) == 60

    def test_it_goes_on_where_many_are_invalid_or_not_measurable(self) -> None:
        names = self.objectives or self.feedback_objectives()

        def evaluate_mixed(number: int, proposal: Proposal) -> Evaluation:
            if number % 3 == 0:
                return Evaluation(number=number, proposal=proposal, status=EvaluationStatus.INVALID)
            if number % 3 == 1:
                return Evaluation(
                    number=number,
                    proposal=proposal,
                    status=EvaluationStatus.JUDGED,
                    scores=dict.fromkeys(names),
                    measurement=Measurement(
                        objectives=dict.fromkeys(names),
                        features=self.measure(self.space().to_unit(proposal.values)).features,
                    ),
                )
            return self.judged(number, proposal)

        assert len(self.play(self.create(), 60, 4, evaluate_mixed)) == 60

    def test_it_goes_on_where_no_gene_had_an_effect(self) -> None:
        idle = tuple(range(len(self.space())))

        def judge(number: int, proposal: Proposal) -> Evaluation:
            return replace(self.judged(number, proposal), without_effect=idle)

        told = self.play(self.create(), 60, 4, judge)
        assert len(told) == 60
        assert all(e.proposal.redrawn >= 0 for e in told)
        again = self.play(self.create(), 60, 4, judge)
        assert [_key(e.proposal) for e in told] == [_key(e.proposal) for e in again]

    def test_it_goes_on_where_every_run_is_hit_by_others(self) -> None:
        by_another = Verdict(
            oracle="collision",
            ego="ego_0",
            outcome=Outcome.VIOLATED,
            message="",
            at_fault=False,
            time=1.0,
        )

        def judge(number: int, proposal: Proposal) -> Evaluation:
            return replace(self.judged(number, proposal), violations=(), verdicts=(by_another,))

        assert len(self.play(self.create(), 60, 4, judge)) == 60

    def test_it_asks_only_for_objectives_that_its_feedback_measures(self) -> None:
        known = self.feedback_objectives()
        assert set(self.objectives) <= set(known)

        def judge(number: int, proposal: Proposal) -> Evaluation:
            told = self.judged(number, proposal)
            measured = self.measure(self.space().to_unit(proposal.values))
            # All of its feedback, and no others: another name raises `UnknownObjective`.
            values = {
                name: measured.objectives.get(name) if name in measured.objectives else 0.5
                for name in known
            }
            return replace(told, scores=values, measurement=replace(measured, objectives=values))

        assert len(self.play(self.create(), 60, 4, judge)) == 60

    def test_it_goes_by_the_objectives_that_a_campaign_chooses(self) -> None:
        if self.plugin.guidance not in (Guidance.ONE, Guidance.SEVERAL):
            return
        aim = Aim(name="chosen", target=0.0)

        def judge(sign: float) -> Callable[[int, Proposal], Evaluation]:
            def evaluate(number: int, proposal: Proposal) -> Evaluation:
                told = self.judged(number, proposal)
                unit = self.space().to_unit(proposal.values)
                measured = self.measure(unit)
                value = 2.0 + sign * float(unit.mean())
                values = {**dict.fromkeys(measured.objectives, 0.5), "chosen": value}
                measurement = replace(measured, objectives=values)
                return replace(told, violations=(), verdicts=(), measurement=measurement)

            return evaluate

        one, other = (
            self.play(self.create(aims=(aim,)), self.budget, 3, judge(sign)) for sign in (1.0, -1.0)
        )
        assert [_key(e.proposal) for e in one] != [_key(e.proposal) for e in other]

    def test_it_starts_from_known_candidates(self) -> None:
        space = self.space()
        starts = list(space.sample(np.random.default_rng(11), 6))

        def start() -> list[Evaluation]:
            return self.play(WarmStart(self.create(), starts, space), 60, 4)

        told = start()
        used = [one.proposal for one in told if one.proposal.origin == ORIGIN]
        assert len(used) == len(starts)
        for proposal, known in zip(used, starts, strict=True):
            # Beside a reference run, only the actors may differ from it.
            same = proposal.values == known
            assert same.all() or (proposal.reference is not None and same.any())
        assert all(parent < one.number for one in told for parent in one.proposal.parents)
        assert [_key(one.proposal) for one in told] == [_key(one.proposal) for one in start()]

    def test_its_integer_parameters_are_bounded(self) -> None:
        unbounded = [
            one.name
            for one in describe_parameters(self.plugin.parameters)
            for schema in (one.schema, *one.schema.get("anyOf", ()))
            if schema.get("type") == "integer" and not {"maximum", "exclusiveMaximum"} & set(schema)
        ]
        assert not unbounded, (
            f"without an upper bound a small request can take all memory: {unbounded}; declare "
            "`Annotated[int, within_budget(1)]` for candidates to be simulated, else "
            "`Annotated[int, Field(ge=1, le=1000)]`"
        )

    def test_its_defaults_are_allowed_with_any_budget(self) -> None:
        for budget in (1, 10**6):
            assert list(problems_of_tester(self.plugin, {}, budget)) == []

    def test_a_wrong_order_is_refused(self) -> None:
        tester = self.create()
        first = tester.ask(2)
        assert first
        with pytest.raises(SearchError, match="is expected"):
            tester.tell(self.judged(5, first[0]))

    def test_telling_what_was_not_asked_is_refused(self) -> None:
        tester = self.create()
        stranger = Proposal(values=self.space().sample(np.random.default_rng(1)), origin="initial")
        with pytest.raises(SearchError):
            tester.tell(self.judged(0, stranger))

    def test_asking_without_room_is_refused(self) -> None:
        with pytest.raises(SearchError, match="room"):
            self.create().ask(0)


def _key(proposal: Proposal) -> tuple[bytes, str, int, tuple[int, ...], AdversarySource | None]:
    values = proposal.values.tobytes()
    return values, proposal.origin, proposal.generation, proposal.parents, proposal.adversary
