"""Methods against a baseline."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import TypeAdapter

from drivora_service.errors import CampaignError, UnknownName
from drivora_service.studies.campaign_figures import CampaignFigures
from drivora_service.studies.comparison.campaign_measures import (
    MEASURES,
    Difference,
    compare_campaigns,
    measure,
)


def figures(method: str, seed: int, at_fault: int, scenario: str = "s") -> CampaignFigures:
    return CampaignFigures(
        campaign=f"{scenario}-{method}-{seed}",
        method=method,
        scenario=scenario,
        seed=seed,
        simulations=100,
        invalid_share=0.0,
        failed_share=0.0,
        failing=at_fault,
        at_fault=at_fault,
        avoidable=at_fault // 2,
        not_measurable=0,
        unavoidable=at_fault - at_fault // 2,
        undetermined=0,
        not_judged=0,
        preventable=0,
        not_at_fault=0,
        kinds=min(at_fault, 3),
        avoidable_kinds=min(at_fault // 2, 3),
        oracles=1,
        groups=None,
        situations=at_fault,
        avoidable_situations=at_fault // 2,
        first_failure=10 if at_fault else None,
        first_avoidable=20 if at_fault > 1 else None,
        found=(),
        found_avoidable=(),
        gene_coverage=0.5,
        simulation_s=10.0,
        own_s=1.0,
    )


def study(shift: int, scenarios: tuple[str, ...] = ("s",)) -> list[CampaignFigures]:
    random = np.random.default_rng(0)
    return [
        figures(method, seed, int(random.poisson(5 + more)), scenario)
        for scenario in scenarios
        for method, more in (("random", 0), ("avfuzzer", shift))
        for seed in range(20)
    ]


def test_a_method_that_finds_more_is_better() -> None:
    rows = compare_campaigns(study(6), "random", [measure("at_fault")])
    assert len(rows) == 1
    row = rows[0]
    assert row.a12 > 0.9
    assert row.is_better
    assert row.median > row.baseline_median
    assert (row.repetitions, row.baseline_repetitions) == (20, 20)


def test_a_difference_by_chance_is_undecided() -> None:
    (row,) = compare_campaigns(study(0), "random", [measure("at_fault")])
    assert not row.is_better


def test_fewer_simulations_to_the_first_failure_are_better() -> None:
    found = [replace(f, first_failure=5 + f.seed) for f in study(6) if f.method == "avfuzzer"]
    late = [replace(f, first_failure=60 + f.seed) for f in study(6) if f.method == "random"]
    (row,) = compare_campaigns(found + late, "random", [measure("first_failure")])
    assert row.a12 == 1.0
    # A campaign that found nothing counts as later than all of its simulations.
    never = [replace(f, first_failure=None) for f in late]
    (row,) = compare_campaigns(found + never, "random", [measure("first_failure")])
    assert row.baseline_median == 101.0


def test_the_first_failure_and_the_first_that_counts_are_measures_of_their_own() -> None:
    found = [
        replace(f, first_failure=1, first_avoidable=50 + f.seed, budget=120)
        for f in study(6)
        if f.method == "random"
    ]
    other = [
        replace(f, first_failure=2, first_avoidable=None, budget=120)
        for f in study(6)
        if f.method == "avfuzzer"
    ]
    names = ("first_failure", "first_avoidable")
    all_, target = compare_campaigns(found + other, "random", [measure(name) for name in names])
    assert (all_.median, all_.baseline_median) == (2.0, 1.0)
    assert (target.median, target.baseline_median) == (121.0, 59.5)


def test_a_tester_that_ends_early_without_a_failure_did_not_find_one_early() -> None:
    found = [replace(f, first_failure=60 + f.seed) for f in study(6) if f.method == "random"]
    ended = [
        replace(f, simulations=30, budget=100, first_failure=None)
        for f in study(6)
        if f.method == "avfuzzer"
    ]
    (row,) = compare_campaigns(found + ended, "random", [measure("first_failure")])
    assert row.median == 101.0
    assert row.judgement == "worse, large"


def test_p_is_corrected_for_all_rows_of_a_measure() -> None:
    one = compare_campaigns(study(2), "random", [measure("at_fault")])
    three = compare_campaigns(study(2, ("s", "t", "u")), "random", [measure("at_fault")])
    assert one[0].p_holm == one[0].p
    assert len(three) == 3
    smallest = min(three, key=lambda row: row.p)
    assert smallest.p_holm == pytest.approx(min(1.0, 3 * smallest.p))


def test_a_measure_that_some_do_not_have_gives_no_row() -> None:
    assert compare_campaigns(study(2), "random", [measure("network_coverage")]) == ()


def test_every_measure_can_be_compared() -> None:
    known = [
        replace(
            f,
            network_coverage=0.3,
            law_coverage=0.2,
            first_failure=3,
            first_failure_s=1.0,
            first_avoidable_s=2.0,
            unchanged_share=0.5,
        )
        for f in study(2)
    ]
    assert len(compare_campaigns(known, "random")) == len(MEASURES)


def test_at_equal_time_seconds_to_the_first_failure_count_in_place_of_simulations() -> None:
    early = [
        replace(f, first_failure=2, first_failure_s=2.0, time_limit_s=9.0)
        for f in study(0)
        if f.method == "avfuzzer"
    ]
    # Few simulations were made in this time, so that one more than all of them would seem early.
    never = [
        replace(f, simulations=1, first_failure=None, time_limit_s=9.0)
        for f in study(0)
        if f.method == "random"
    ]
    wanted = [measure("first_failure"), measure("first_failure_s")]
    (row,) = compare_campaigns(early + never, "random", wanted)
    assert row.measure == "first_failure_s"
    assert (row.median, row.baseline_median) == (2.0, 9.0)
    assert row.a12 == 1.0


@pytest.mark.parametrize(
    ("a12", "p", "judgement"),
    [
        (0.71, 0.01, "better, large"),
        (0.29, 0.01, "worse, large"),
        (0.65, 0.01, "better, medium"),
        (0.4, 0.01, "worse, small"),
        (0.51, 0.01, "better, negligible"),
        (0.99, 0.05, "undecided"),
    ],
)
def test_the_judgement_states_the_better_method_and_the_size(
    a12: float, p: float, judgement: str
) -> None:
    (row,) = compare_campaigns(study(1), "random", [measure("at_fault")])
    assert replace(row, a12=a12, p_holm=p).judgement == judgement


@pytest.mark.parametrize(
    ("campaigns", "baseline", "message"),
    [
        (study(1), "samota", "no campaign of 'samota'"),
        ([f for f in study(1) if f.method == "random"], "random", "nothing to compare"),
        ([*study(1), figures("avfuzzer", 0, 1, "t")], "random", "on 't' there is no"),
        ([*study(1), replace(study(1)[0], campaign="twin")], "random", "the same search"),
        ([*study(1), figures("samota", 0, 1)], "random", "one campaign of 'samota' only"),
    ],
)
def test_campaigns_that_cannot_be_compared_are_refused(
    campaigns: list[CampaignFigures], baseline: str, message: str
) -> None:
    with pytest.raises(CampaignError, match=message):
        compare_campaigns(campaigns, baseline)


def test_an_unknown_measure_is_reported_with_the_known_ones() -> None:
    with pytest.raises(UnknownName, match="at_fault"):
        measure("beauty")


@given(
    st.lists(st.integers(0, 2), min_size=2, max_size=4),
    st.lists(st.integers(0, 2), min_size=2, max_size=4),
)
def test_few_repetitions_that_find_little_can_be_compared(
    ours: list[int], theirs: list[int]
) -> None:
    """Most measures of a small study have one value in all campaigns."""
    found = [figures("avfuzzer", seed, count) for seed, count in enumerate(ours)]
    found += [figures("random", seed, count) for seed, count in enumerate(theirs)]
    rows = compare_campaigns(found, "random")
    as_json = TypeAdapter(Difference)
    assert {"avoidable", "gene_coverage"} <= {row.measure for row in rows}
    for row in rows:
        assert 0.0 <= row.p <= row.p_holm <= 1.0
        # A client reads it, which NaN in JSON would prevent.
        assert as_json.validate_json(as_json.dump_json(row)) == row
    assert next(row for row in rows if row.measure == "gene_coverage").p_holm == 1.0
