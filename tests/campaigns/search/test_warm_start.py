"""Searches that start from known candidates, in a world that can be computed."""

from __future__ import annotations

import numpy as np
import pytest

from drivora_service.campaigns.records.journal import MemoryJournal
from drivora_service.campaigns.search.warm_start import ORIGIN, ShiftedCheckpoints, WarmStart
from drivora_service.errors import SearchError
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.runs.candidate import Reference
from drivora_service.search.tester import (
    REFERENCE_ORIGIN,
    Evaluation,
    EvaluationStatus,
    Proposal,
    Tester,
)
from drivora_service.search.testers.script import Script, ScriptedTester
from drivora_service.testing.gene_spaces import small_space
from tests.campaigns.analytic import climber, run, sequence

SPACE = small_space()


def known(count: int) -> list[FloatArray]:
    return list(SPACE.sample(np.random.default_rng(42), count))


def warm(count: int = 9, tester: Tester | None = None) -> WarmStart:
    return WarmStart(tester or climber(), known(count), SPACE)


def evaluated(number: int, proposal: Proposal) -> Evaluation:
    return Evaluation(number=number, proposal=proposal, status=EvaluationStatus.JUDGED)


def test_known_candidates_are_simulated_first_and_in_order() -> None:
    journal = MemoryJournal()
    run(journal, tester=warm())
    records = list(journal.evaluations())
    origins = [record.proposal.origin for record in records]
    assert origins.count(ORIGIN) == 9
    first = [record for record in records if record.proposal.origin == ORIGIN]
    for record, values in zip(first, known(9), strict=True):
        # This world repairs one gene.
        assert (record.proposal.values != values).sum() <= 1


def test_the_tester_learns_from_them() -> None:
    inside = climber()
    run(MemoryJournal(), tester=warm(9, inside))
    started = [one for one in inside.told if one.proposal.origin == ORIGIN]
    assert started
    assert all(one.measurement for one in started if one.status is EvaluationStatus.JUDGED)
    assert [one.number for one in inside.told] == list(range(len(inside.told)))


def test_a_resumed_campaign_repeats_them_bit_for_bit() -> None:
    whole = MemoryJournal()
    run(whole, tester=warm(25))
    records = list(whole.evaluations())
    cold = MemoryJournal()
    run(cold, tester=climber())
    assert sequence(records) != sequence(list(cold.evaluations()))
    for stored in range(0, len(records), 9):
        journal = MemoryJournal(records[:stored])
        run(journal, tester=warm(25))
        assert sequence(list(journal.evaluations())) == sequence(records)


def generations(told: list[tuple[Evaluation, ...]]) -> Script:
    """A method with two drawn candidates, and children of both."""
    drawn = SPACE.sample(np.random.default_rng(1), 2)
    told.append((yield tuple(Proposal(values=row, origin="initial") for row in drawn)))
    while True:
        numbers = tuple(one.number for one in told[0])
        children = tuple(
            Proposal(values=row, origin="mutation", generation=len(told), parents=numbers)
            for row in SPACE.sample(np.random.default_rng(len(told) + 1), 2)
        )
        told.append((yield children))


def test_more_than_a_method_draws_are_simulated_before_it_breeds() -> None:
    told: list[tuple[Evaluation, ...]] = []
    tester = WarmStart(ScriptedTester(generations(told)), known(5), SPACE)
    evaluations: list[Evaluation] = []
    for _ in range(9):
        (proposal,) = tester.ask(1)
        evaluation = evaluated(len(evaluations), proposal)
        evaluations.append(evaluation)
        tester.tell(evaluation)
    assert [one.proposal.origin for one in evaluations] == [ORIGIN] * 5 + ["mutation"] * 4
    for evaluation, values in zip(evaluations, known(5), strict=False):
        assert np.array_equal(evaluation.proposal.values, values)
    # By the campaign's numbers outside, and by its own inside.
    assert evaluations[5].proposal.parents == (0, 1)
    assert [[one.number for one in generation] for generation in told[:2]] == [[0, 1], [2, 3]]
    assert told[1][0].proposal.parents == (0, 1)


def compared(reference: Reference) -> Script:
    """A method that compares its candidates with a reference run."""
    scene = SPACE.from_unit(np.full(len(SPACE), 0.5))
    yield (Proposal(values=scene, origin=REFERENCE_ORIGIN),)
    while True:
        yield tuple(
            Proposal(values=scene, origin="mutation", parents=(0,), reference=reference)
            for _ in range(2)
        )


def test_the_reference_run_stays_and_its_scene_too() -> None:
    tester = WarmStart(ScriptedTester(compared(Reference())), known(3), SPACE)
    (first,) = tester.ask(4)
    assert first.origin == REFERENCE_ORIGIN
    tester.tell(evaluated(0, first))
    one, other = tester.ask(4)
    assert (one.origin, other.origin) == (ORIGIN, ORIGIN)
    assert one.reference == Reference()
    weather = next(block for block in SPACE.blocks if block.name == "weather").slice
    vehicle = next(block for block in SPACE.blocks if block.name == "vehicle_0").slice
    assert np.array_equal(one.values[weather], first.values[weather])
    assert np.array_equal(one.values[vehicle], known(1)[0][vehicle])


def test_what_the_tester_refuses_is_refused() -> None:
    tester = warm(2)
    (proposal,) = tester.ask(1)
    with pytest.raises(SearchError, match="asked with room for 0"):
        WarmStart(ScriptedTester(compared(Reference())), known(1), SPACE).ask(0)
    scripted = WarmStart(ScriptedTester(compared(Reference())), known(1), SPACE)
    with pytest.raises(SearchError, match="none is expected"):
        scripted.tell(evaluated(0, proposal))


def test_checkpoints_count_the_evaluations_of_the_campaign() -> None:
    kept: dict[int, bytes] = {}

    class Kept:
        def last(self) -> tuple[int, bytes] | None:
            return max(kept.items(), default=None)

        def save(self, told: int, state: bytes) -> None:
            kept[told] = state

    checkpoints = ShiftedCheckpoints(Kept(), 5)
    assert checkpoints.last() is None
    checkpoints.save(10, b"state")
    assert kept == {15: b"state"}
    assert checkpoints.last() == (10, b"state")
