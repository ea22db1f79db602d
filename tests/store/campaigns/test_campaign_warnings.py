"""When a campaign is said to say little, and in which words."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from drivora_service.oracles.verdict import Answer, Outcome, Verdict
from drivora_service.runs.run_report import RunFailure, RunStatus
from drivora_service.store.campaigns.campaign_records import CampaignCounts
from drivora_service.store.campaigns.campaign_warnings import (
    CampaignWarning,
    WarningCode,
    campaign_warnings,
    upper_bound,
)
from drivora_service.store.campaigns.seed_run_records import (
    SeedRun,
    seed_runs_from_json,
    seed_runs_to_json,
)


def violated(oracle: str, time: float | None = None, **changes: Any) -> Verdict:
    return Verdict(
        oracle=oracle, ego="ego", outcome=Outcome.VIOLATED, message="", time=time, **changes
    )


def seed(*failures: Verdict, **changes: Any) -> SeedRun:
    values = {"place": 0, "name": "", "run_id": "r", "status": RunStatus.FINISHED, **changes}
    return SeedRun(failures=failures, **values)


def found(*seeds: SeedRun, is_finished: bool = False, **counts: Any) -> list[CampaignWarning]:
    return [*campaign_warnings(CampaignCounts(**counts), seeds, is_finished=is_finished)]


def codes(*seeds: SeedRun, is_finished: bool = False, **counts: Any) -> list[str]:
    return [str(one.code) for one in found(*seeds, is_finished=is_finished, **counts)]


def test_a_campaign_without_simulations_has_no_warning() -> None:
    assert codes() == codes(is_finished=True) == codes(seed()) == []


@pytest.mark.parametrize(
    ("judged", "violating", "is_warned"),
    [(9, 9, False), (10, 10, True), (10, 9, True), (20, 17, False), (100, 90, True)],
)
def test_nearly_all_of_ten_and_more_simulations_are_all(
    judged: int, violating: int, is_warned: bool
) -> None:
    counts: dict[str, Any] = {"judged": judged, "violating": violating}
    assert codes(**counts) == (["all_fail"] if is_warned else [])
    assert codes(**counts, is_finished=True) == codes(**counts)


def test_that_none_fails_is_said_at_the_end_and_before_after_many() -> None:
    assert codes(judged=99) == []
    assert codes(judged=100) == codes(judged=3, is_finished=True) == ["none_fails"]
    assert codes(judged=100, violating=1) == codes(judged=100, failed=2, agent_failed=2) == []
    (warning,) = found(judged=200, is_finished=True)
    assert warning.message == (
        "No failure in 200 simulations: if they were drawn at random, at most 1.5 % of such "
        "simulations fail (95 % confidence)."
    )


def test_violations_that_do_not_count_are_named_where_none_fails() -> None:
    (warning,) = found(judged=200, is_finished=True, not_at_fault=3, preventable=2)
    assert warning.message.endswith(
        "Simulations with a violation that does not count: 2 not at fault, but avoidable, "
        "3 not at fault."
    )
    assert "meet the ego" not in warning.advice
    (warning,) = found(judged=200, is_finished=True)
    assert "meet the ego" in warning.advice


def test_the_bound_of_a_rate_is_that_of_the_binomial_distribution() -> None:
    for n in (1, 7, 30, 1000):
        # With this rate, n simulations without a failure have a probability of 5 %.
        assert (1.0 - upper_bound(n)) ** n == pytest.approx(0.05)
    assert upper_bound(300) == pytest.approx(3.0 / 300, rel=0.01)


def test_an_ads_that_fails_itself_comes_first() -> None:
    broken = seed(
        status=RunStatus.AGENT_FAILED,
        error=RunFailure(cause="agent_raised", message="KeyError: 'lidar'"),
    )
    assert codes(broken, failed=2, agent_failed=2) == ["seed_fails"]
    first, second = found(broken, failed=3, agent_failed=3)
    assert first.message.startswith("The ADS itself failed in 3 of 3 simulations")
    assert second.message == (
        "The seed scenario itself fails: the ADS itself failed (agent_raised: KeyError: 'lidar')."
    )
    assert codes(failed=9, agent_failed=9, judged=1) == ["ads_fails"]
    assert codes(failed=8, agent_failed=8, judged=2) == []
    # For other reasons, or from before these were counted.
    assert codes(failed=5, agent_failed=1) == codes(failed=5, agent_failed=None) == ["no_results"]


def test_a_failing_seed_is_named_with_what_fails() -> None:
    avoidable = {"at_fault": True, "avoidable": Answer.YES}
    many = seed(
        *(violated(name, float(n), **avoidable) for n, name in enumerate("aabcd")), violated("e")
    )
    (warning,) = found(many)
    assert warning.message == (
        "The seed scenario itself fails: a at 0.0 s (at fault), b at 2.0 s (at fault), c at 3.0 s "
        "(at fault) and 2 more."
    )
    (warning,) = found(seed(name="x"), *(seed(violated("b"), name=name) for name in "pqrst"))
    assert warning.message == (
        "5 of 6 seed scenarios fail as they are: 'p' b; 'q' b; 'r' b; and 2 more."
    )


def test_where_all_fail_it_is_said_whether_the_seed_passes() -> None:
    counts: dict[str, Any] = {"judged": 10, "violating": 10}
    (unknown,) = found(**counts)
    (passing,) = found(seed(), **counts)
    _, failing = found(seed(violated("collision")), **counts)
    assert unknown.message == failing.message == "10 of 10 simulations fail."
    assert passing.message.startswith("10 of 10 simulations fail; the seed passes, so that")


def test_every_warning_names_a_section_of_the_page(repository: Path) -> None:
    warnings = [
        *found(seed(violated("b")), judged=10, violating=10),
        *found(failed=3, agent_failed=3),
        *found(failed=3),
        *found(judged=1, is_finished=True),
    ]
    assert {one.code for one in warnings} == set(WarningCode)
    for warning in warnings:
        name, _, anchor = warning.page.partition("#")
        headings = [
            line.removeprefix("## ").lower().replace(" ", "-")
            for line in (repository / name).read_text("utf-8").splitlines()
            if line.startswith("## ")
        ]
        assert anchor in headings


def test_runs_of_seeds_are_read_as_they_were_written() -> None:
    runs = (
        seed(violated("collision", 4.25, at_fault=True, evidence={"face": "front"}), name="Straße"),
        seed(place=1, status=RunStatus.TIMED_OUT, error=RunFailure(cause="x", message="y")),
    )
    assert seed_runs_from_json(seed_runs_to_json(runs)) == runs
    assert seed_runs_from_json("[]") == ()
