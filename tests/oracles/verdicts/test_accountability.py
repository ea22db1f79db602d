"""The accountability of an ego, from fault and avoidability."""

from __future__ import annotations

import itertools

import pytest

from drivora_service.oracles.verdict import Answer, Outcome, Verdict
from drivora_service.oracles.verdicts.accountability import (
    IN_WORDS,
    Accountability,
    accountable,
    strongest,
)


@pytest.mark.parametrize(
    ("at_fault", "undetermined", "avoidable", "expected"),
    [
        (True, False, Answer.YES, Accountability.AVOIDABLE),
        # A rule that does not ask, such as a red light, is the ego's own to keep.
        (True, False, None, Accountability.AVOIDABLE),
        (True, False, Answer.NOT_MEASURABLE, Accountability.NOT_MEASURABLE),
        (True, False, Answer.NO, Accountability.UNAVOIDABLE),
        (None, True, Answer.YES, Accountability.UNDETERMINED),
        (None, False, None, Accountability.NOT_JUDGED),
        (False, False, Answer.YES, Accountability.PREVENTABLE),
        (False, False, Answer.NO, Accountability.NOT_AT_FAULT),
        (False, False, Answer.NOT_MEASURABLE, Accountability.NOT_AT_FAULT),
        (False, False, None, Accountability.NOT_AT_FAULT),
    ],
)
def test_each_combination_has_its_name(
    at_fault: bool | None, undetermined: bool, avoidable: Answer | None, expected: Accountability
) -> None:
    assert accountable(at_fault, avoidable, undetermined=undetermined) is expected


def test_every_combination_has_one_and_every_one_has_words() -> None:
    found = {
        accountable(fault, avoidable, undetermined=undetermined)
        for fault, avoidable, undetermined in itertools.product(
            (True, False, None), (None, *Answer), (True, False)
        )
    }
    assert found == set(Accountability) == set(IN_WORDS)


def test_what_is_only_physically_avoidable_does_not_count() -> None:
    verdict = Verdict(
        oracle="collision",
        ego="ego",
        outcome=Outcome.VIOLATED,
        message="",
        at_fault=True,
        avoidable=Answer.NO,
        physically_avoidable=Answer.YES,
    )
    assert strongest([verdict]) is Accountability.UNAVOIDABLE
    assert strongest([]) is None
