from __future__ import annotations

import pytest

from drivora_service.oracles.verdict import Answer, Outcome, Severity
from drivora_service.oracles.verdicts.failure_definition import Counted, FailureDefinition
from drivora_service.oracles.verdicts.failure_facts import failure_sentence
from drivora_service.runs.run_report import RunStatus
from drivora_service.suites.paired.failure_rules import Rules, Unfinished
from drivora_service.suites.paired.paired_runs import PairedRun
from tests.suites.paired.samples import lost, run, verdict

MIXED = run(
    "mixed",
    passes=("collision", "discomfort", "wrong_way", "off_road"),
    verdicts=(
        verdict("collision", at_fault=False),
        verdict("red_light", avoidable=Answer.NO),
        verdict("speeding", at_fault=None),
        verdict("failure_to_yield", at_fault=None, undetermined=True),
        verdict("stop_sign", time=9.0, message="later"),
        verdict("stop_sign", time=4.0, message="first"),
        verdict("discomfort", severity=Severity.OBSERVATION, at_fault=None),
        verdict("wrong_way", Outcome.NOT_MEASURABLE, at_fault=None),
    ),
)


def failures(one: PairedRun, rules: Rules) -> set[str]:
    judged = rules.judge(one)
    assert judged is not None
    return set(judged.failures)


@pytest.mark.parametrize(
    ("counted", "expected"),
    [
        (Counted.ACCOUNTABLE, {"speeding", "stop_sign"}),
        (Counted.AT_FAULT, {"speeding", "red_light", "stop_sign"}),
        (
            Counted.ANY,
            {"collision", "red_light", "speeding", "failure_to_yield", "stop_sign"},
        ),
    ],
)
def test_the_violations_that_count(counted: Counted, expected: set[str]) -> None:
    assert failures(MIXED, Rules(definition=FailureDefinition(counts=counted))) == expected


def test_named_oracles_count_alone_and_observations_among_them() -> None:
    rules = Rules(definition=FailureDefinition(oracles=("collision", "discomfort", "wrong_way")))
    judged = rules.judge(MIXED)
    assert judged is not None
    assert set(judged.failures) == {"discomfort"}
    assert judged.oracles == {"discomfort", "collision", "wrong_way"}
    assert judged.not_measurable == {"wrong_way"}


def test_a_failure_is_told_by_its_first_violation() -> None:
    judged = Rules().judge(MIXED)
    assert judged is not None
    found = judged.failures["stop_sign"]
    assert (found.time, found.violations) == (4.0, 2)
    assert found.sentence == failure_sentence(MIXED.verdicts[5], town="tee-town")


def test_a_destination_missed_by_a_collision_is_no_failure_of_its_own() -> None:
    missed = run(
        "missed",
        passes=("destination",),
        verdicts=(
            verdict("destination", at_fault=None, evidence={"reason": "collision"}),
            verdict("collision", at_fault=False),
        ),
    )
    assert failures(missed, Rules()) == set()
    late = run("late", verdicts=(verdict("destination", at_fault=None, evidence={}),))
    assert failures(late, Rules()) == {"destination"}
    assert failures(missed, Rules(definition=FailureDefinition(oracles=("destination",)))) == {
        "destination"
    }


@pytest.mark.parametrize("status", [one for one in RunStatus if one is not RunStatus.FINISHED])
@pytest.mark.parametrize("unfinished", Unfinished)
def test_runs_without_a_judgement(status: RunStatus, unfinished: Unfinished) -> None:
    judged = Rules(unfinished=unfinished).judge(lost("x", status, "agent_hung"))
    counts = {
        Unfinished.NONE: False,
        Unfinished.AGENT: status is RunStatus.AGENT_FAILED,
        Unfinished.ALL: status.is_final and status not in (RunStatus.CANCELLED, RunStatus.INVALID),
    }[unfinished]
    assert (judged is not None) == counts
    if judged is not None:
        (found,) = judged.failures.values()
        assert (found.oracle, "agent hung" in found.sentence) == (status, True)
    named = Rules(unfinished=unfinished, definition=FailureDefinition(oracles=("collision",)))
    assert named.judge(lost("x", status)) is None
