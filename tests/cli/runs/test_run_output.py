"""What commands print of a run."""

from __future__ import annotations

from typing import Any

import pytest

from drivora_service.api.schemas.runs import Run
from drivora_service.cli.runs.run_output import (
    ScenarioResult,
    print_result,
    say_notes,
    summary,
)
from drivora_service.oracles.verdict import Answer, Outcome, Verdict
from drivora_service.oracles.verdicts.accountability import Accountability, accountability
from drivora_service.oracles.verdicts.failure_definition import (
    Counted,
    FailureDefinition,
    StatedDefinition,
    state_definition,
)
from drivora_service.oracles.verdicts.verdict_json import verdict_content
from drivora_service.shapes import adapter
from tests.client.examples import JOB

FAULTS: dict[Accountability, dict[str, Any]] = {
    Accountability.AVOIDABLE: {"at_fault": True, "avoidable": Answer.YES},
    Accountability.NOT_MEASURABLE: {"at_fault": True, "avoidable": Answer.NOT_MEASURABLE},
    Accountability.UNAVOIDABLE: {"at_fault": True, "avoidable": Answer.NO},
    Accountability.UNDETERMINED: {"undetermined": True},
    Accountability.NOT_JUDGED: {},
    Accountability.PREVENTABLE: {"at_fault": False, "avoidable": Answer.YES},
    Accountability.NOT_AT_FAULT: {"at_fault": False, "avoidable": Answer.NO},
}


def collision(**changes: Any) -> Verdict:
    return Verdict(
        oracle="collision", ego="ego", outcome=Outcome.VIOLATED, message="Collided.", **changes
    )


def run_with(*verdicts: Verdict, **changes: Any) -> Run:
    content = {
        **JOB,
        "status": "finished",
        "verdicts": [verdict_content(verdict) for verdict in verdicts],
        "observations_url": "",
        "scenario_url": "",
        "violations": 1,
        **changes,
    }
    run: Run = adapter(Run).validate_python(content)
    return run


@pytest.mark.parametrize("degree", list(Accountability))
def test_the_fault_of_every_degree_has_words(
    degree: Accountability, capsys: pytest.CaptureFixture[str]
) -> None:
    verdict = collision(**FAULTS[degree])
    assert accountability(verdict) is degree
    run = run_with(verdict)
    assert summary(run).startswith("collision")
    print_result(ScenarioResult(scenario="a", run=run))
    assert "Collided." in capsys.readouterr().out


def test_a_printed_collision_says_until_when_it_was_avoidable(
    capsys: pytest.CaptureFixture[str],
) -> None:
    verdict = collision(
        at_fault=True,
        avoidable=Answer.YES,
        time=5.0,
        evidence={"avoidability": {"latest_before": 0.75}},
    )
    print_result(ScenarioResult(scenario="a", run=run_with(verdict)))
    assert "Collided. Avoidable until 4.25 s." in " ".join(capsys.readouterr().out.split())


def test_what_follows_is_counted_apart_and_names_its_cause(
    capsys: pytest.CaptureFixture[str],
) -> None:
    missed = Verdict(
        oracle="destination",
        ego="ego",
        outcome=Outcome.VIOLATED,
        message="Not arrived.",
        follows="collision",
    )
    run = run_with(collision(at_fault=True), missed)
    assert summary(run) == "collision (at fault); 1 that follows"
    print_result(ScenarioResult(scenario="a", run=run))
    assert "(follows from collision)" in " ".join(capsys.readouterr().out.split())


def test_the_failures_and_what_counts_are_named(capsys: pytest.CaptureFixture[str]) -> None:
    definition = state_definition((FailureDefinition(counts=Counted.AT_FAULT),))
    words = adapter(StatedDefinition).dump_python(definition, mode="json")
    run = run_with(
        collision(at_fault=False),
        collision(at_fault=True, time=3.25),
        failures=1,
        failing_verdicts=[1],
        definition=words,
    )
    print_result(ScenarioResult(scenario="a", run=run))
    shown = capsys.readouterr().out
    assert "\nFailures: 1 (collision of ego at 3.2 s)\n" in shown
    assert f"\nFailures are {definition.words}\n" in shown


def test_an_ads_that_failed_is_named_as_a_failure(capsys: pytest.CaptureFixture[str]) -> None:
    run = run_with(status="agent_failed", failures=1)
    print_result(ScenarioResult(scenario="a", run=run))
    assert "\nFailures: 1 (the ADS itself failed)\n" in capsys.readouterr().out


def test_the_first_of_many_notes_are_printed(capsys: pytest.CaptureFixture[str]) -> None:
    say_notes(
        [
            ScenarioResult(scenario="quiet"),
            ScenarioResult(scenario="fast", notes=tuple(f"/place/{n}: 50 m/s" for n in range(12))),
        ]
    )
    lines = capsys.readouterr().err.splitlines()
    assert lines[0] == "fast: note: /place/0: 50 m/s"
    assert lines[-1] == "2 more notes; drivora validate prints them all"
    assert len(lines) == 11
