"""Gates: the violations that count."""

from __future__ import annotations

from typing import Any

import pytest

from drivora_service.cli.runs.run_gates import Gate, read_gate
from drivora_service.errors import ConfigurationError
from drivora_service.oracles.verdict import Answer, Outcome, Severity, Verdict
from drivora_service.oracles.verdicts.accountability import Accountability
from drivora_service.oracles.verdicts.failure_definition import Counted

ORACLES = ("collision", "red_light", "discomfort")


_FAULT: dict[Accountability, dict[str, Any]] = {
    Accountability.AVOIDABLE: {"at_fault": True, "avoidable": Answer.YES},
    Accountability.NOT_MEASURABLE: {"at_fault": True, "avoidable": Answer.NOT_MEASURABLE},
    Accountability.UNAVOIDABLE: {"at_fault": True, "avoidable": Answer.NO},
    Accountability.UNDETERMINED: {"undetermined": True},
    Accountability.NOT_JUDGED: {},
    Accountability.PREVENTABLE: {"at_fault": False, "avoidable": Answer.YES},
    Accountability.NOT_AT_FAULT: {"at_fault": False, "avoidable": Answer.NO},
}


def violation(
    oracle: str, accountability: Accountability = Accountability.AVOIDABLE, *, seen: bool = False
) -> Verdict:
    return Verdict(
        oracle=oracle,
        ego="ego",
        outcome=Outcome.VIOLATED,
        message="",
        severity=Severity.OBSERVATION if seen else Severity.MAJOR,
        **_FAULT[accountability],
    )


def test_a_run_with_seven_violations_is_one_failing_run() -> None:
    answer = Gate().judge([[violation("red_light")] * 6 + [violation("collision")], []])
    assert (answer.fails, answer.failing_runs, answer.violations) == (True, 1, 7)
    assert str(answer) == (
        "gate failed: 1 failing run, 7 violations (collision in 1, red_light in 1)"
    )


def test_a_run_that_the_ads_itself_ended_fails_whichever_oracles_count() -> None:
    names = [f"run-{number}" for number in range(23)]
    for gate in (Gate(), read_gate(["collision=30"], ORACLES, counted_by="Drivora")):
        answer = gate.judge([[]], agent_failed=names)
        assert (answer.fails, answer.failing_runs, answer.violations) == (True, 23, 0)
        said, named, _definition = answer.lines()
        assert said == "gate failed: 23 failing runs, 0 violations (agent_failed in 23)"
        assert named.startswith("the ADS failed in run-0, run-1, ")
        assert named.endswith(", run-19 and 3 more")


def test_a_gate_says_what_it_counts() -> None:
    gate = read_gate(["red_light"], ORACLES, counted_by="Drivora", counts=Counted.AT_FAULT)
    assert gate.judge([]).lines() == (
        "gate passed: 0 failing runs, 0 violations",
        "Failures are violations that an ego is accountable for, or at fault without a way out "
        "(at_fault), of red light",
    )


def test_observations_fail_only_a_gate_that_names_them() -> None:
    runs = [[violation("discomfort", Accountability.NOT_JUDGED, seen=True)]]
    assert not Gate().judge(runs).fails
    assert read_gate(["discomfort"], ORACLES, counted_by="Drivora").judge(runs).fails
    assert not read_gate(["collision"], ORACLES, counted_by="Drivora").judge(runs).fails


@pytest.mark.parametrize(
    ("accountability", "fails"),
    [
        (Accountability.AVOIDABLE, True),
        (Accountability.NOT_MEASURABLE, True),
        (Accountability.NOT_JUDGED, True),
        (Accountability.UNAVOIDABLE, False),
        (Accountability.UNDETERMINED, False),
        (Accountability.PREVENTABLE, False),
        (Accountability.NOT_AT_FAULT, False),
    ],
)
def test_only_what_an_ego_is_accountable_for_fails(
    accountability: Accountability, fails: bool
) -> None:
    answer = Gate().judge([[violation("collision", accountability)]])
    assert answer.fails == fails
    assert answer.passed_over == (not fails)
    assert answer.preventable == (accountability is Accountability.PREVENTABLE)


def test_what_a_careful_driver_would_have_prevented_can_be_counted() -> None:
    runs = [[violation("collision", Accountability.PREVENTABLE)]]
    assert str(Gate().judge(runs)).endswith("1 that do not count (1 not at fault, but avoidable)")
    gate = read_gate([], ORACLES, counted_by="Drivora", counts=Counted.PREVENTABLE)
    assert gate.judge(runs).fails


def test_an_oracle_may_be_violated_in_as_many_runs_as_are_allowed() -> None:
    gate = read_gate(["red_light=1", "collision"], ORACLES, counted_by="Drivora")
    assert not gate.judge([[violation("red_light")] * 3]).fails
    assert gate.judge([[violation("red_light")], [violation("red_light")]]).fails
    assert gate.judge([[violation("red_light")], [violation("collision")]]).fails


@pytest.mark.parametrize(
    ("text", "said"),
    [("sleeping", "no oracle 'sleeping'; known: collision"), ("collision=few", "collision=0")],
)
def test_a_gate_that_cannot_be_meant_is_refused(text: str, said: str) -> None:
    with pytest.raises(ConfigurationError, match=said):
        read_gate([text], ORACLES, counted_by="Drivora")
