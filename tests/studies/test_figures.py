"""Campaigns in figures."""

from __future__ import annotations

import numpy as np
import pytest

from drivora_service.oracles.verdict import Answer, Outcome, Verdict
from drivora_service.runs.report import RunReport, RunStatus
from drivora_service.search.genes import Block, Gene, GeneKind, GeneSpace, Part
from drivora_service.search.tester import EvaluationStatus, Proposal
from drivora_service.store.campaign_records import EvaluationRecord
from drivora_service.studies.figures import (
    Subject,
    duration_s,
    figures_of,
    pairwise_coverage,
    within_time,
)

SPACE = GeneSpace(
    (
        Block(
            name="weather",
            part=Part.WEATHER,
            start=0,
            genes=(
                Gene(name="wetness", kind=GeneKind.CONTINUOUS, low=0.0, high=100.0),
                Gene(name="kind", kind=GeneKind.CATEGORY, low=0.0, high=1.0),
                Gene(name="fixed", kind=GeneKind.CONTINUOUS, low=3.0, high=3.0),
                Gene(name="fog", kind=GeneKind.CONTINUOUS, low=0.0, high=100.0),
            ),
        ),
    )
)
SUBJECT = Subject(campaign="c1", method="random", scenario="s", seed=1)


def record(
    number: int,
    *keys: str,
    status: EvaluationStatus = EvaluationStatus.JUDGED,
    counterpart: str = "vehicle_0",
    role: str = "npc_vehicle",
    at_fault: bool | None = True,
    avoidable: Answer | None = None,
    undetermined: bool = False,
) -> EvaluationRecord:
    violations = tuple(
        Verdict(
            oracle=key.split(":")[0],
            ego="ego_0",
            outcome=Outcome.VIOLATED,
            message="",
            at_fault=at_fault,
            avoidable=avoidable,
            undetermined=undetermined,
            counterpart=counterpart,
            evidence={"counterpart_role": role} if key.startswith("collision") else {},
        )
        for key in keys
    )
    return EvaluationRecord(
        number=number,
        proposal=Proposal(values=np.array([10.0 * number, 0.0, 3.0, 50.0]), origin="initial"),
        status=status,
        document_sha256="",
        report=RunReport(run_id=str(number), status=RunStatus.FINISHED, wall_time_s=0.1),
        violations=violations,
        failure_kinds=keys,
        search_s=0.01,
        prepare_s=0.01,
    )


def test_simulations_are_told_apart_by_what_the_ego_is_accountable_for() -> None:
    records = [
        record(0, "collision:a", avoidable=Answer.YES),
        record(1, "collision:a", avoidable=Answer.NO),
        record(2, "collision:a", avoidable=Answer.NOT_MEASURABLE),
        record(3, "collision:a", at_fault=None, undetermined=True),
        record(4, "blocked:a", at_fault=None),
        record(5, "red_light:b"),
        record(6),
    ]
    figures = figures_of(SUBJECT, records, [SPACE])
    assert (figures.failing, figures.at_fault) == (6, 4)
    assert (figures.avoidable, figures.unavoidable, figures.undetermined) == (2, 1, 1)


def test_everything_is_counted_once() -> None:
    records = [
        record(0),
        record(1, status=EvaluationStatus.INVALID),
        record(2, "collision:a"),
        record(3, "collision:a", "red_light:b", counterpart="walker_1", role="npc_walker"),
        record(4, status=EvaluationStatus.FAILED),
        record(5, "collision:a", at_fault=None),
    ]
    figures = figures_of(SUBJECT, records, [SPACE], groups=2)
    assert figures.simulations == 5
    assert figures.invalid_share == pytest.approx(1 / 6)
    assert figures.failed_share == pytest.approx(1 / 5)
    assert (figures.failing, figures.at_fault) == (3, 2)
    assert figures.kinds == 2
    # With a vehicle, with a walker, and the red light.
    assert figures.oracles == 3
    # Invalid candidates are no simulations: the second simulation is evaluation 2.
    assert figures.first_failure == 2
    assert figures.found == (2, 3)
    assert figures.simulation_s == pytest.approx(0.5)
    assert figures.own_share == pytest.approx(0.12 / 0.5)


def test_collisions_are_told_apart_by_what_the_other_was_and_not_by_its_name() -> None:
    names = ("vehicle_0", "van", "lead", "bus_0")
    records = [record(n, "collision:a", counterpart=name) for n, name in enumerate(names)]
    assert figures_of(SUBJECT, records, [SPACE]).oracles == 1
    stood = record(4, "collision:a", counterpart="parked_van", role="npc_obstacle")
    assert figures_of(SUBJECT, [*records, stood], [SPACE]).oracles == 2


def test_a_campaign_without_failures_has_no_first_one() -> None:
    figures = figures_of(SUBJECT, [record(0), record(1)], [SPACE])
    assert figures.first_failure is None
    assert (figures.failing, figures.kinds, figures.found) == (0, 0, ())


def test_equal_time_counts_the_methods_own_time() -> None:
    records = [record(n) for n in range(10)]
    assert [r.number for r in within_time(records, 0.37)] == [0, 1, 2]


def test_what_comes_after_the_time_limit_does_not_count() -> None:
    records = [record(0), record(1, "collision:a"), record(2, "red_light:b"), record(3)]
    figures = figures_of(SUBJECT, records, [SPACE], time_limit_s=0.25)
    assert (figures.simulations, figures.found, figures.time_limit_s) == (2, (2,), 0.25)
    assert figures.first_failure_s == pytest.approx(0.24)
    # The time that all took leaves nothing out.
    assert figures_of(SUBJECT, records, [SPACE], time_limit_s=duration_s(records)).simulations == 4


def test_coverage_counts_pairs_of_levels_that_occur() -> None:
    # Levels: wetness 4, kind 2, fog 4: 4*2 + 4*4 + 2*4 = 32 pairs; one candidate has 3 of them.
    one = np.array([[10.0, 0.0, 3.0, 50.0]])
    assert pairwise_coverage(one, SPACE) == pytest.approx(3 / 32)
    # The same levels again add nothing; another kind adds the two pairs that hold it.
    more = np.array([[10.0, 0.0, 3.0, 50.0], [12.0, 0.0, 3.0, 52.0], [10.0, 1.0, 3.0, 50.0]])
    assert pairwise_coverage(more, SPACE) == pytest.approx(5 / 32)


def test_many_samples_cover_everything() -> None:
    assert pairwise_coverage(SPACE.sample(np.random.default_rng(0), 2000), SPACE) == 1.0


def test_nothing_tried_covers_nothing() -> None:
    assert pairwise_coverage(np.empty((0, 4)), SPACE) == 0.0
