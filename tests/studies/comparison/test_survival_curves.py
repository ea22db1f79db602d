"""Survival curves against SciPy's estimate, and what is an event, and censored when."""

from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import CensoredData, ecdf

from drivora_service.studies.campaign_figures import CampaignFigures
from drivora_service.studies.comparison.survival_curves import (
    Survival,
    kaplan_meier,
    kinds_reached,
    survival_curves,
)
from drivora_service.studies.comparison.survival_files import survival_markdown, write_survival
from tests.studies.comparison.test_campaign_measures import figures

TIMES = st.lists(st.integers(1, 40), max_size=25)


def campaign(
    seed: int,
    found: tuple[int, ...],
    *,
    method: str = "random",
    simulations: int = 100,
    budget: int | None = 100,
    time_limit_s: float | None = None,
) -> CampaignFigures:
    return replace(
        figures(method, seed, 0),
        found_avoidable=found,
        simulations=simulations,
        budget=budget,
        time_limit_s=time_limit_s,
    )


@given(events=TIMES, censored=TIMES)
def test_the_curve_is_scipys(events: list[int], censored: list[int]) -> None:
    at, share = kaplan_meier(events, censored)
    assert at == (0, *sorted(set(events)))
    if not events + censored:
        assert share == (1.0,)
        return
    expected = ecdf(CensoredData(uncensored=events, right=censored)).sf
    assert share == pytest.approx(expected.evaluate(np.array(at)).tolist(), abs=1e-12)


def test_by_hand() -> None:
    # The data of Freireich et al. 1963, 6-MP, with the estimates in Kleinbaum and Klein, table 2.1.
    events = [6, 6, 6, 7, 10, 13, 16, 22, 23]
    censored = [6, 9, 10, 11, 17, 19, 20, 25, 32, 32, 34, 35]
    at, share = kaplan_meier(events, censored)
    assert at == (0, 6, 7, 10, 13, 16, 22, 23)
    assert [round(one, 4) for one in share] == [
        1.0, 0.8571, 0.8067, 0.7529, 0.6902, 0.6275, 0.5378, 0.4482,
    ]  # fmt: skip


def test_the_kth_kind_counts_and_its_median_is_when_half_have_it() -> None:
    repetitions = [
        campaign(1, (5, 20, 31)),
        campaign(2, (8,)),
        campaign(3, (1, 2, 60)),
        campaign(4, ()),
    ]
    first, second, third = survival_curves(repetitions)
    assert [one.kinds for one in (first, second, third)] == [1, 2, 3]
    assert (first.repetitions, first.events, first.median) == (4, 3, 5)
    assert first.at == (0, 1, 5, 8, 100)
    assert first.share == pytest.approx((1.0, 0.75, 0.5, 0.25, 0.25))
    assert (second.events, second.median) == (2, 20)
    assert (third.events, third.median, third.at) == (2, 60, (0, 31, 60, 100))
    # With fewer than half there is no median.
    (first, *_) = survival_curves([*repetitions, *(campaign(n, ()) for n in range(5, 9))])
    assert (first.repetitions, first.events, first.median) == (8, 3, None)


def test_only_numbers_of_kinds_that_were_reached_have_curves() -> None:
    assert kinds_reached([campaign(1, ())]) == (1,)
    assert kinds_reached([campaign(1, (3, 4, 5, 6))]) == (1, 2, 3)
    assert kinds_reached([campaign(1, ()), campaign(2, tuple(range(1, 10)))]) == (1, 2, 3, 5)


def test_a_tester_that_ended_early_stays_without_it_until_the_budget() -> None:
    (curve,) = survival_curves(
        [campaign(1, (), simulations=10), campaign(2, (50,)), campaign(3, (90,))]
    )
    # Were it censored at 10, the share after 50 would be a half.
    assert curve.at == (0, 50, 90, 100)
    assert curve.share == pytest.approx((1.0, 2 / 3, 1 / 3, 1 / 3))


def test_at_equal_time_a_campaign_is_censored_where_its_time_ended() -> None:
    limited = [
        campaign(n, found, simulations=simulations, time_limit_s=9.0)
        for n, found, simulations in ((1, (), 10), (2, (50,), 60), (3, (), 70))
    ]
    (curve,) = survival_curves(limited)
    assert curve.at == (0, 50, 70)
    assert curve.share == pytest.approx((1.0, 0.5, 0.5))
    expected = ecdf(CensoredData(uncensored=[50], right=[10, 70])).sf
    assert curve.share[1] == pytest.approx(expected.evaluate([50.0])[0])
    nothing = survival_curves([campaign(1, (), simulations=0, time_limit_s=9.0)])
    assert (nothing[0].at, nothing[0].share) == ((0,), (1.0,))


def curves() -> tuple[Survival, ...]:
    return survival_curves(
        [
            *(campaign(seed, (), method="random") for seed in range(3)),
            *(campaign(seed, (4 + seed, 30), method="=fuzzer") for seed in range(3)),
        ]
    )


def test_the_files_hold_the_medians(tmp_path: Path) -> None:
    written = write_survival(curves(), "random", tmp_path)
    assert [path.name for path in written] == [
        "survival.csv",
        "survival-1.svg",
        "survival-1.png",
        "survival-2.svg",
        "survival-2.png",
    ]
    with written[0].open(newline="") as file:
        rows = list(csv.reader(file))
    assert rows == [
        ["scenario", "method", "k", "repetitions", "events", "median"],
        ["s", "random", "1", "3", "0", ""],
        ["s", "'=fuzzer", "1", "3", "3", "5"],
        ["s", "random", "2", "3", "0", ""],
        ["s", "'=fuzzer", "2", "3", "3", "30"],
    ]
    lines = survival_markdown(curves(), ["survival-1.svg"])
    assert "| scenario | method | n | first kind | second kind |" in lines
    assert "| s | random | 3 | >100 (0) | >100 (0) |" in lines
    assert "| s | =fuzzer | 3 | 5 (3) | 30 (3) |" in lines
    assert lines[-1] == "\n![survival-1.svg](survival-1.svg)"


def test_agents_have_curves_of_their_own(tmp_path: Path) -> None:
    campaigns = [campaign(seed, (seed,)) for seed in range(1, 5)]
    made = survival_curves(campaigns, agent_of=lambda f: "idm" if f.seed < 3 else "plant-lite")
    assert [(one.agent, one.repetitions, one.median) for one in made] == [
        ("idm", 2, 1),
        ("plant-lite", 2, 3),
    ]
    table, *_ = write_survival(made, "random", tmp_path)
    assert table.read_text().splitlines()[:2] == [
        "scenario,agent,method,k,repetitions,events,median",
        "s,idm,random,1,2,2,1",
    ]
    assert "| s, plant-lite | random | 2 | 3 (2) |" in survival_markdown(made)
