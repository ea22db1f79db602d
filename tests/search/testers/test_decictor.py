"""Decictor: the reference run, the mutation of actors, and the generations."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivora_service.errors import SearchError
from drivora_service.feedback.decictor import CONSISTENCY, REFERENCE
from drivora_service.feedback.measurement import Measurement
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.oracles.verdict import Outcome, Verdict
from drivora_service.runs.candidate import Reference
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
from drivora_service.search.testers.decictor.mutation import ActorChanges, optional_actors
from drivora_service.search.testers.decictor.search import DECICTOR, DecictorParameters
from drivora_service.testing.gene_spaces import small_space
from drivora_service.testing.tester_contract import TesterContract

ROWS = tuple((float(ego), t, 10.0 * t, 3.0 * ego, 0.0, 10.0, 0.0) for ego in (0, 1) for t in (0, 9))
PATHS = tuple(tuple(row[1:] for row in ROWS if row[0] == ego) for ego in (0.0, 1.0))


class TestDecictor(TesterContract):
    plugin = DECICTOR
    objectives = (CONSISTENCY,)

    def measure(self, unit: FloatArray) -> Measurement:
        told = super().measure(unit)
        return Measurement(objectives=told.objectives, features={REFERENCE: ROWS})


def make(
    space: GeneSpace | None = None, components: Components | None = None, **more: Any
) -> Tester:
    context = TesterContext(
        space=space or small_space(), random=np.random.default_rng(3), budget=100
    )
    return DECICTOR.create(context, DecictorParameters(**more), components or Components())


def evaluation(
    number: int,
    proposal: Proposal,
    value: float | None = None,
    rows: tuple[tuple[float, ...], ...] = (),
    **more: Any,
) -> Evaluation:
    return Evaluation(
        number=number,
        proposal=proposal,
        status=EvaluationStatus.JUDGED,
        measurement=Measurement(objectives={CONSISTENCY: value}, features={REFERENCE: rows}),
        **more,
    )


FAILURE = Verdict(
    oracle="non_optimal_decision", ego="ego", outcome=Outcome.VIOLATED, message="", time=1.0
)


def play(
    tester: Tester, count: int, judge: Callable[[int, Proposal], Evaluation]
) -> list[tuple[Proposal, Evaluation]]:
    """Asks and tells one by one, after a reference run that succeeds."""
    (first,) = tester.ask(4)
    tester.tell(evaluation(0, first, rows=ROWS))
    told = []
    for number in range(1, count + 1):
        (proposal,) = tester.ask(1)
        told.append((proposal, judge(number, proposal)))
        tester.tell(told[-1][1])
    return told


def test_nothing_is_mutated_before_the_reference_is_known() -> None:
    tester = make()
    (first,) = tester.ask(8)
    assert first.origin == "reference"
    assert first.reference is None
    assert all(first.values[block.start] == 0.0 for block in optional_actors(small_space()))
    assert tester.ask(8) == ()
    tester.tell(evaluation(0, first, rows=ROWS))
    generation = tester.ask(8)
    assert len(generation) == 4
    assert {one.reference for one in generation} == {Reference(paths=PATHS)}
    assert {one.parents for one in generation} == {(0,)}


def test_a_seed_scenario_with_paths_of_its_own_keeps_them() -> None:
    tester = make()
    (first,) = tester.ask(1)
    tester.tell(evaluation(0, first, value=-0.01))
    assert {one.reference for one in tester.ask(4)} == {Reference()}


def test_a_reference_that_does_not_arrive_is_drawn_again_while_something_varies() -> None:
    tester = make(reference_tries=2)
    drawn = []
    for number in range(2):
        (proposal,) = tester.ask(1)
        drawn.append(proposal.values.tobytes())
        tester.tell(evaluation(number, proposal))
    assert len(set(drawn)) == 2
    (third,) = tester.ask(1)
    tester.tell(evaluation(2, third))
    with pytest.raises(SearchError, match=r"did not arrive \(3 tries\)"):
        tester.ask(1)


def test_without_anything_else_that_varies_it_is_an_error_at_once() -> None:
    blocks = tuple(b for b in small_space(egos=0).blocks if b.part is not Part.LIGHTS)
    tester = make(GeneSpace(tuple(b for b in blocks if b.part is not Part.WEATHER)))
    (first,) = tester.ask(1)
    tester.tell(evaluation(0, first))
    with pytest.raises(SearchError, match="completes its task"):
        tester.ask(1)


def test_a_space_without_actors_that_may_be_absent_is_refused() -> None:
    with pytest.raises(SearchError, match="optional: true"):
        make(small_space(vehicles=0, walkers=0))


def test_conditions_and_egos_stay_as_in_the_reference_whatever_mutates() -> None:
    space = small_space()
    mutable = np.zeros(len(space), dtype=np.bool_)
    for block in optional_actors(space):
        mutable[block.slice] = True
    for components in (Components(), Components(mutation=RedrawGene())):
        tester = make(components=components)
        (first,) = tester.ask(1)
        tester.tell(evaluation(0, first, rows=ROWS))
        for number in range(1, 41):
            (proposal,) = tester.ask(1)
            assert np.array_equal(proposal.values[~mutable], first.values[~mutable])
            tester.tell(evaluation(number, proposal, value=-float(number)))


def test_failures_and_what_is_not_measurable_are_not_bred() -> None:
    def judge(number: int, proposal: Proposal) -> Evaluation:
        if number % 3 == 0:
            return evaluation(number, proposal, value=-100.0, violations=(FAILURE,))
        if number % 3 == 1:
            return evaluation(number, proposal, value=None)
        return evaluation(number, proposal, value=-1.0)

    parents = {parent for one, _ in play(make(), 80, judge) for parent in one.parents}
    assert parents - {0}, "others than the reference are bred"
    assert all(parent % 3 == 2 for parent in parents - {0})


def test_scenarios_that_differ_more_are_bred_more_often() -> None:
    def judge(number: int, proposal: Proposal) -> Evaluation:
        return evaluation(number, proposal, value=-10.0 if number == 2 else -0.001)

    told = play(make(), 40, judge)
    parents = [parent for one, _ in told[4:] for parent in one.parents]
    assert parents.count(2) > 0.5 * len(parents)


@given(seed=st.integers(0, 2**32 - 1), rounds=st.integers(1, 12))
def test_a_mutant_differs_only_in_actors_of_one_kind(seed: int, rounds: int) -> None:
    space, random = small_space(), np.random.default_rng(seed)
    changes = ActorChanges(
        static_rate=0.5, most_added=4, removed_share=0.2, change_rate=0.5, sigma=0.05
    )
    values = space.sample(random)
    for _ in range(rounds):
        mutant = changes.mutate(values, space, random)
        assert space.within(mutant)
        assert not np.array_equal(mutant, values)
        differing = [b for b in space.blocks if (mutant[b.slice] != values[b.slice]).any()]
        assert all(block in optional_actors(space) for block in differing)
        presence = [b for b in differing if mutant[b.start] != values[b.start]]
        # Either one is added, or, where all are there, some are removed.
        assert len(presence) == 1
        values = mutant
