"""Testers written as scripts."""

from __future__ import annotations

import numpy as np
import pytest

from drivora_service.errors import SearchError
from drivora_service.search.tester import Evaluation, EvaluationStatus, Proposal
from drivora_service.search.testers.script import Script, ScriptedTester


def proposal(value: float) -> Proposal:
    return Proposal(values=np.array([value]), origin="initial")


def evaluation(number: int, what: Proposal) -> Evaluation:
    return Evaluation(number=number, proposal=what, status=EvaluationStatus.FAILED)


def script(seen: list[tuple[int, ...]]) -> Script:
    for generation in ((1.0, 2.0, 3.0), (), (4.0,)):
        told = yield tuple(proposal(value) for value in generation)
        seen.append(tuple(e.number for e in told))


def test_a_generation_is_proposed_as_there_is_room_and_waited_for() -> None:
    seen: list[tuple[int, ...]] = []
    tester = ScriptedTester(script(seen))
    first = tester.ask(2)
    second = tester.ask(2)
    assert [p.values[0] for p in (*first, *second)] == [1.0, 2.0, 3.0]
    assert tester.ask(2) == ()
    for number, asked in enumerate((*first, *second)):
        assert seen == []
        tester.tell(evaluation(number, asked))
    last = tester.ask(5)
    assert [p.values[0] for p in last] == [4.0]
    assert seen == [(0, 1, 2), ()]
    tester.tell(evaluation(3, last[0]))
    assert tester.ask(5) == ()
    assert tester.ask(5) == ()
    assert seen == [(0, 1, 2), (), (3,)]


def test_refused_ask_and_tell_change_nothing() -> None:
    tester = ScriptedTester(script([]))
    with pytest.raises(SearchError, match="room"):
        tester.ask(0)
    asked = tester.ask(3)
    assert len(asked) == 3
    with pytest.raises(SearchError, match="is expected"):
        tester.tell(evaluation(1, asked[1]))
    for number, what in enumerate(asked):
        tester.tell(evaluation(number, what))
    with pytest.raises(SearchError, match="none is expected"):
        tester.tell(evaluation(3, asked[0]))
