from __future__ import annotations

import random

import pytest

from drivora_service.benchmarking.card import card_of, figures_of, worst_run
from drivora_service.benchmarking.card_text import COLUMNS, cells
from drivora_service.oracles.verdict import Answer, Outcome, Verdict
from drivora_service.oracles.verdicts.artefact_verdicts import ARTEFACT
from drivora_service.runs.run_report import RunStatus
from tests.benchmarking.made_up_runs import AGENT, failed, finished, violation

RUNS = (
    finished(1),
    finished(2, violation("collision", at_fault=False), score=60.0, comfort=0.5),
    finished(
        3,
        violation("collision", at_fault=False),
        violation("collision", at_fault=True, message="hit the back of npc_1"),
        score=40.0,
    ),
    finished(4, violation("destination"), violation("red_light"), score=50.0, network="arterial"),
    failed(5, RunStatus.AGENT_FAILED, "agent_raised", "ZeroDivisionError"),
)


def test_counts_are_of_runs() -> None:
    figures = figures_of(RUNS)
    assert (figures.runs, figures.judged) == (5, 4)
    assert (figures.arrivals, figures.clean_arrivals) == (3, 2)
    assert (figures.collisions, figures.at_fault_collisions) == (2, 1)
    assert figures.red_lights == 1
    assert figures.comfortable == 3
    assert figures.comfort == pytest.approx(3.5 / 4)
    assert figures.route_completion == pytest.approx(360.0 / 5)
    assert figures.efficiency is None


def test_unavoidable_collisions_are_counted_apart() -> None:
    answers = (Answer.YES, Answer.NO, Answer.NOT_MEASURABLE)
    runs = [
        finished(n, violation("collision", at_fault=True, avoidable=answer))
        for n, answer in enumerate(answers)
    ]
    figures = figures_of(runs)
    assert (figures.at_fault_collisions, figures.avoidable_collisions) == (3, 1)
    assert figures.preventable_collisions == 0
    of_others = [
        finished(n, violation("collision", at_fault=False, avoidable=answer))
        for n, answer in enumerate(answers)
    ]
    assert figures_of(of_others).preventable_collisions == 1


def test_a_failing_agent_scores_nothing_and_a_failing_machine_does_not_count() -> None:
    assert figures_of(RUNS).driving_score == pytest.approx(250.0 / 5)
    crashed = failed(6, RunStatus.SIMULATOR_CRASHED, "signal")
    assert figures_of((*RUNS, crashed)).driving_score == pytest.approx(250.0 / 5)
    hung = failed(6, RunStatus.TIMED_OUT, "wall_time_limit")
    assert figures_of((*RUNS, hung)).driving_score == pytest.approx(250.0 / 6)


def test_a_run_that_the_simulator_spoilt_is_not_judged() -> None:
    artefact = Verdict(
        oracle="collision",
        ego="ego_0",
        outcome=Outcome.NOT_MEASURABLE,
        message="npc jumped into the ego.",
        at_fault=False,
        evidence={ARTEFACT: "jumped"},
    )
    spoilt = finished(6, artefact, violation("red_light"), score=None, comfort=None)
    card = card_of(AGENT, (*RUNS, spoilt))
    plain = card_of(AGENT, RUNS)
    assert card.total.judged == plain.total.judged
    assert card.total.driving_score == plain.total.driving_score
    assert card.total.red_lights == plain.total.red_lights
    assert card.violated == plain.violated
    assert card.failed_otherwise == 1
    (cause,) = (one for one in card.failures if one.cause == "simulation_artefact")
    assert (cause.runs, cause.example) == (1, "npc jumped into the ego.")


def test_what_could_not_be_measured_is_none_and_never_zero() -> None:
    figures = figures_of((finished(1, score=None, comfort=float("nan")),))
    assert figures.driving_score is None
    assert figures.comfort is None
    nothing = figures_of((failed(1, RunStatus.SIMULATOR_CRASHED, "signal"),))
    assert nothing.driving_score is None
    assert nothing.step_cost_median_us is None


def test_cost_of_a_step_is_median_and_percentile_over_runs() -> None:
    figures = figures_of([finished(n, step_cost_us=float(n)) for n in range(1, 102)])
    assert figures.step_cost_median_us == pytest.approx(51.0)
    assert figures.step_cost_p95_us == pytest.approx(96.0)


def test_what_the_agent_takes_of_a_step_is_told_apart() -> None:
    figures = figures_of([finished(n, agent_cost_us=float(n)) for n in range(1, 101)])
    assert figures.agent_cost_median_us == pytest.approx(50.5)
    without_agents = figures_of([finished(1, agent_cost_us=None)])
    assert without_agents.agent_cost_median_us is None
    assert without_agents.step_cost_median_us is not None
    assert cells(without_agents)[COLUMNS.index("agent (ms)")] == "-"
    assert cells(figures)[COLUMNS.index("agent (ms)")] == "0.05"


def test_a_card_has_oracles_causes_and_networks() -> None:
    card = card_of(AGENT, RUNS)
    assert [(v.oracle, v.runs, v.at_fault) for v in card.violated] == [
        ("collision", 2, 1),
        ("destination", 1, 0),
        ("red_light", 1, 0),
    ]
    assert card.violated[0].example == "hit the back of npc_1"
    assert card.violated[0].example_run == "tee-town-03"
    (failure,) = card.failures
    assert (failure.cause, failure.runs, failure.example) == (
        "agent_raised",
        1,
        "ZeroDivisionError",
    )
    assert [(own.network, own.figures.runs) for own in card.networks] == [
        ("arterial", 1),
        ("tee-town", 4),
    ]
    assert card.failed_otherwise == 0
    lost = failed(6, RunStatus.INFRASTRUCTURE_FAILED, "worker_lost")
    assert card_of(AGENT, (*RUNS, lost)).failed_otherwise == 1


def test_a_card_does_not_depend_on_the_order_in_which_runs_ended() -> None:
    shuffled = list(RUNS)
    random.Random(1).shuffle(shuffled)
    assert card_of(AGENT, shuffled) == card_of(AGENT, RUNS)


def test_the_run_in_which_most_went_wrong_is_shown() -> None:
    shown = card_of(AGENT, RUNS).shown
    assert shown is not None
    assert shown.name == "tee-town-03"
    innocent = [run for run in RUNS if run.number != 3]
    worst = worst_run(innocent)
    assert worst is not None
    assert worst.name == "arterial-04"


def test_of_runs_without_wrongs_the_longest_is_shown() -> None:
    runs = (finished(1, sim_time_s=20.0), finished(2, sim_time_s=40.0), finished(3, sim_time_s=30))
    longest = worst_run(runs)
    assert longest is not None
    assert longest.number == 2
    assert worst_run((failed(1, RunStatus.TIMED_OUT, "wall_time_limit"),)) is None


def test_an_agent_that_ran_nothing_has_an_empty_card() -> None:
    card = card_of(AGENT, ())
    assert (card.total.runs, card.total.driving_score) == (0, None)
    assert (card.networks, card.violated, card.failures, card.shown) == ((), (), (), None)
