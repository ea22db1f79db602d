"""Gates: the violations that count."""

from __future__ import annotations

import pytest

from drivora_service.cli.runs.run_gates import Gate, Violation, read_gate, violations_of_run
from drivora_service.errors import ConfigurationError
from drivora_service.oracles.verdict import Outcome, Severity, Verdict
from drivora_service.oracles.verdicts.accountability import Accountability

ORACLES = ("collision", "red_light", "discomfort")


def violation(
    oracle: str, accountability: Accountability = Accountability.AVOIDABLE, *, seen: bool = False
) -> Violation:
    return Violation(oracle=oracle, is_observation=seen, accountability=accountability)


def test_a_run_with_seven_violations_is_one_failing_run() -> None:
    answer = Gate().judge([[violation("red_light")] * 6 + [violation("collision")], []])
    assert (answer.fails, answer.failing_runs, answer.violations) == (True, 1, 7)
    assert str(answer) == (
        "gate failed: 1 failing run, 7 violations (collision in 1, red_light in 1)"
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
        (Accountability.NOT_AT_FAULT, False),
    ],
)
def test_only_what_an_ego_is_accountable_for_fails(
    accountability: Accountability, fails: bool
) -> None:
    answer = Gate().judge([[violation("collision", accountability)]])
    assert answer.fails == fails
    assert answer.passed_over == (not fails)


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


def test_verdicts_are_read() -> None:
    verdict = Verdict(
        oracle="discomfort",
        ego="ego",
        outcome=Outcome.VIOLATED,
        message="rough",
        severity=Severity.OBSERVATION,
    )
    (one,) = violations_of_run([verdict])
    assert one == violation("discomfort", Accountability.NOT_JUDGED, seen=True)
