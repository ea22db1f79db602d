"""What a gate counts."""

from __future__ import annotations

import pytest

from drivora_service.cli.gates import Broken, Gate, broken_in_result, read_gate
from drivora_service.errors import ConfigurationError
from drivora_service.oracles.accountability import Accountability

RULES = ("collision", "red_light", "discomfort")


def broken(
    rule: str, accountability: Accountability = Accountability.AVOIDABLE, *, seen: bool = False
) -> Broken:
    return Broken(rule=rule, is_observation=seen, accountability=accountability)


def test_a_run_with_seven_violations_is_one_failing_run() -> None:
    answer = Gate().judge([[broken("red_light")] * 6 + [broken("collision")], []])
    assert (answer.fails, answer.failing_runs, answer.violations) == (True, 1, 7)
    assert str(answer) == (
        "gate failed: 1 failing run, 7 violations (collision in 1, red_light in 1)"
    )


def test_observations_fail_only_a_gate_that_names_them() -> None:
    runs = [[broken("discomfort", Accountability.NOT_JUDGED, seen=True)]]
    assert not Gate().judge(runs).fails
    assert read_gate(["discomfort"], RULES, whose="there is").judge(runs).fails
    assert not read_gate(["collision"], RULES, whose="there is").judge(runs).fails


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
    answer = Gate().judge([[broken("collision", accountability)]])
    assert answer.fails == fails
    assert answer.passed_over == (not fails)


def test_a_rule_may_be_broken_in_as_many_runs_as_are_allowed() -> None:
    gate = read_gate(["red_light=1", "collision"], RULES, whose="there is")
    assert not gate.judge([[broken("red_light")] * 3]).fails
    assert gate.judge([[broken("red_light")], [broken("red_light")]]).fails
    assert gate.judge([[broken("red_light")], [broken("collision")]]).fails


@pytest.mark.parametrize(
    ("text", "said"),
    [("sleeping", "no rule 'sleeping'; there are: collision"), ("collision=few", "collision=0")],
)
def test_a_gate_that_cannot_be_meant_is_refused(text: str, said: str) -> None:
    with pytest.raises(ConfigurationError, match=said):
        read_gate([text], RULES, whose="there is")


def test_printed_verdicts_are_read() -> None:
    verdict = {
        "oracle": "discomfort",
        "severity": "observation",
        "at_fault": None,
        "avoidable": None,
        "undetermined": False,
    }
    (one,) = broken_in_result([verdict])
    assert one == broken("discomfort", Accountability.NOT_JUDGED, seen=True)
