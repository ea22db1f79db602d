"""Campaigns in figures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivora_service.oracles.verdict import Answer, Outcome, Verdict
from drivora_service.oracles.verdicts.failure_definition import Counted, FailureDefinition
from drivora_service.runs.run_report import RunReport, RunStatus
from drivora_service.search.genes import Block, Gene, GeneKind, GeneSpace, Part
from drivora_service.search.tester import EvaluationStatus, Proposal
from drivora_service.store.campaigns.campaign_records import EvaluationRecord
from drivora_service.studies.campaign_figures import (
    CampaignFigures,
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


DEFINITION = FailureDefinition(
    counts=Counted.POSSIBLY_AT_FAULT, oracles=("blocked", "collision", "red_light")
)


def counted(records: Sequence[EvaluationRecord], **options: Any) -> CampaignFigures:
    return figures_of(SUBJECT, records, [SPACE], definition=DEFINITION, **options)


def hit(oracle: str = "collision", *, at_fault: bool | None = False) -> Verdict:
    return Verdict(
        oracle=oracle, ego="ego_0", outcome=Outcome.VIOLATED, message="", at_fault=at_fault
    )


def with_verdicts(record: EvaluationRecord, *verdicts: Verdict) -> EvaluationRecord:
    return replace(record, report=replace(record.report, verdicts=verdicts))


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
    figures = counted(records)
    assert (figures.failing, figures.at_fault) == (6, 4)
    assert (figures.avoidable, figures.unavoidable, figures.undetermined) == (2, 1, 1)
    assert (figures.not_measurable, figures.not_judged, figures.not_at_fault) == (1, 1, 0)


def test_violations_at_others_fault_are_counted_apart() -> None:
    records = [
        with_verdicts(record(0), hit()),
        # Of an oracle that the campaign does not count, and of no known fault.
        with_verdicts(record(1), hit("tailgating"), hit(at_fault=None)),
        # A failure beside it.
        with_verdicts(record(2, "red_light:b"), hit()),
        record(3, "collision:a", avoidable=Answer.NO),
    ]
    figures = counted(records)
    assert figures.not_at_fault == 1
    assert (figures.failing, figures.avoidable, figures.unavoidable) == (2, 1, 1)


def test_the_target_has_figures_of_its_own() -> None:
    records = [
        record(0, "blocked:a", at_fault=None),
        record(1, "collision:a", avoidable=Answer.NO),
        record(2, "collision:b", avoidable=Answer.NOT_MEASURABLE),
        record(3, status=EvaluationStatus.INVALID),
        record(4, "collision:a", avoidable=Answer.YES),
        record(5, "collision:c", at_fault=None, undetermined=True),
        record(6, "red_light:d"),
        record(7, "collision:a", avoidable=Answer.YES),
    ]
    figures = counted(records)
    assert (figures.first_failure, figures.first_avoidable) == (1, 4)
    assert figures.first_failure_s == pytest.approx(0.12)
    # Records 0 to 4, the invalid one with its preparation and a run of the same length.
    assert figures.first_avoidable_s == pytest.approx(5 * 0.12)
    assert (figures.kinds, figures.avoidable_kinds) == (5, 2)
    assert (figures.found, figures.found_avoidable) == ((1, 2, 3, 5, 6), (4, 6))
    assert (figures.situations, figures.avoidable_situations) == (5, 2)


KINDS = st.sampled_from(["collision:a", "collision:b", "red_light:c", "blocked:d"])
RECORDS = st.lists(
    st.builds(
        lambda keys, at_fault, avoidable, undetermined, others: (
            keys,
            {"at_fault": at_fault, "avoidable": avoidable, "undetermined": undetermined},
            others,
        ),
        st.lists(KINDS, max_size=2),
        # Others' faults are no failures of a campaign.
        st.sampled_from([True, None]),
        st.sampled_from([None, *Answer]),
        st.booleans(),
        st.booleans(),
    ),
    max_size=12,
)


@given(RECORDS)
def test_every_simulation_is_of_one_sort_and_more_of_them_never_find_less(drawn: Any) -> None:
    records = [
        with_verdicts(record(number, *keys, **facts), *([hit()] if others else []))
        for number, (keys, facts, others) in enumerate(drawn)
    ]
    figures = counted(records)
    sorts = (
        figures.avoidable,
        figures.not_measurable,
        figures.unavoidable,
        figures.undetermined,
        figures.not_judged,
    )
    assert sum(sorts) == figures.failing
    assert sum(sorts[:3]) == figures.at_fault
    assert figures.failing + figures.not_at_fault <= figures.simulations
    before = counted(records[:-1])
    for name in ("avoidable", "avoidable_kinds", "avoidable_situations", "kinds", "situations"):
        assert getattr(before, name) <= getattr(figures, name) <= getattr(before, name) + 2
    assert figures.avoidable_kinds <= figures.kinds
    assert figures.avoidable_situations <= figures.situations
    if before.first_avoidable is not None:
        assert figures.first_avoidable == before.first_avoidable


def child(number: int, *parents: int, run: str = "", redrawn: int = 0) -> EvaluationRecord:
    one = record(number)
    return replace(
        one,
        proposal=replace(one.proposal, parents=parents, redrawn=redrawn),
        report=replace(one.report, egos_sha256=run),
    )


def test_mutants_that_change_nothing_have_shares() -> None:
    records = [
        child(0, run="a"),
        child(1, 0, run="a", redrawn=3),
        child(2, 0, run="b"),
        child(3, 0, 2, run="b", redrawn=1),
        child(4, 1, run=""),
        child(5, 4, run="a"),
    ]
    figures = counted(records)
    assert figures.redrawn_share == pytest.approx(4 / (4 + 5))
    # Of the last two, a run or that of the only parent is not known.
    assert figures.unchanged_share == pytest.approx(2 / 3)
    nothing = counted([child(0, run="a"), child(1, run="a")])
    assert (nothing.redrawn_share, nothing.unchanged_share) == (None, None)


def test_everything_is_counted_once() -> None:
    records = [
        record(0),
        record(1, status=EvaluationStatus.INVALID),
        record(2, "collision:a"),
        record(3, "collision:a", "red_light:b", counterpart="walker_1", role="npc_walker"),
        record(4, status=EvaluationStatus.FAILED),
        record(5, "collision:a", at_fault=None),
    ]
    figures = counted(records, groups=2)
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
    assert counted(records).oracles == 1
    stood = record(4, "collision:a", counterpart="parked_van", role="npc_obstacle")
    assert counted([*records, stood]).oracles == 2


def test_a_campaign_without_failures_has_no_first_one() -> None:
    figures = counted([record(0), record(1)])
    assert figures.first_failure is None
    assert (figures.failing, figures.kinds, figures.found) == (0, 0, ())


def test_equal_time_counts_the_methods_own_time() -> None:
    records = [record(n) for n in range(10)]
    assert [r.number for r in within_time(records, 0.37)] == [0, 1, 2]


def test_what_comes_after_the_time_limit_does_not_count() -> None:
    records = [record(0), record(1, "collision:a"), record(2, "red_light:b"), record(3)]
    figures = counted(records, time_limit_s=0.25)
    assert (figures.simulations, figures.found, figures.time_limit_s) == (2, (2,), 0.25)
    assert figures.first_failure_s == pytest.approx(0.24)
    # The time that all took leaves nothing out.
    assert counted(records, time_limit_s=duration_s(records)).simulations == 4


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
