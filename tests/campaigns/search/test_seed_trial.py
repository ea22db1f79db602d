"""Seed scenarios are run as they are, beside a search that they do not change."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

from drivora_service.campaigns.records.journal import MemoryJournal
from drivora_service.campaigns.search.conducting import Watcher, conduct
from drivora_service.campaigns.search.engine import Told
from drivora_service.campaigns.search.seed_trial import MOST_SEEDS
from drivora_service.oracles.verdict import Outcome, Verdict
from drivora_service.runs.run_report import RunFailure, RunReport, RunSpec, RunStatus
from drivora_service.store.campaigns.campaign_records import CampaignRequest, CampaignState
from drivora_service.store.campaigns.campaign_warnings import CampaignWarning, WarningCode
from tests.campaigns.analytic import (
    Computed,
    Values,
    climber,
    part_of,
    perform,
    search_of,
    sequence,
)

Work = Callable[[RunSpec], RunReport]


def seeds_that(**changes: object) -> Work:
    """A world in which the seeds end so; candidates are as in the other tests."""

    def work(spec: RunSpec) -> RunReport:
        if "-seed-" not in spec.run_id:
            return perform(spec)
        plain = RunReport(run_id=spec.run_id, status=RunStatus.FINISHED, sim_time_s=7.0)
        return replace(plain, **changes)  # type: ignore[arg-type] # the test names the fields

    return work


def violated(oracle: str, time: float, **changes: Any) -> Verdict:
    return Verdict(
        oracle=oracle, ego="ego", outcome=Outcome.VIOLATED, message="", time=time, **changes
    )


COLLIDING = seeds_that(
    verdicts=(violated("speeding", 1.0), violated("collision", 4.25, at_fault=True))
)


@pytest.fixture(scope="module")
def alone() -> MemoryJournal:
    """The campaign without runs of its seed."""
    journal = MemoryJournal()
    assert conduct(search_of(climber()), Computed(), journal) is CampaignState.FINISHED
    return journal


@pytest.mark.parametrize("slots", [1, 4])
def test_the_run_of_a_seed_changes_nothing_in_the_search(alone: MemoryJournal, slots: int) -> None:
    journal, evaluator = MemoryJournal(), Computed(slots=slots, work=COLLIDING)
    state = conduct(search_of(climber()), evaluator, journal, try_seeds=True)
    assert state is CampaignState.FINISHED
    assert sequence(list(journal.evaluations())) == sequence(list(alone.evaluations()))
    assert journal.failures() == alone.failures()
    assert not alone.seed_runs()
    (run,) = journal.seed_runs()
    assert (run.place, run.name, run.run_id) == (0, "", "test-seed-0")
    assert (run.status, run.sim_time_s) == (RunStatus.FINISHED, 7.0)
    # The campaign counts collisions only.
    assert [verdict.oracle for verdict in run.failures] == ["collision"]


def test_a_resumed_campaign_does_not_run_its_seed_again() -> None:
    told: list[int] = []

    def requested() -> CampaignRequest:
        return CampaignRequest.PAUSE if len(told) > 20 else CampaignRequest.NONE

    def count(one: Told) -> None:
        told.append(one.record.number)

    journal = MemoryJournal()
    warnings: list[CampaignWarning] = []
    watcher = Watcher(requested=requested, on_told=count, on_warning=warnings.append)
    state = conduct(
        search_of(climber()), Computed(work=COLLIDING), journal, try_seeds=True, watcher=watcher
    )
    assert state is CampaignState.PAUSED
    assert WarningCode.SEED_FAILS in [one.code for one in warnings]
    known = journal.seed_runs()
    assert len(known) == 1
    again, evaluator = list[CampaignWarning](), Computed(work=COLLIDING)
    state = conduct(
        search_of(climber()),
        evaluator,
        journal,
        try_seeds=True,
        watcher=Watcher(on_warning=again.append),
    )
    assert state is CampaignState.FINISHED
    assert min(evaluator.submitted) >= 0
    assert journal.seed_runs() == known
    # The warning is about what the campaign has, and given to each process that runs it.
    assert WarningCode.SEED_FAILS in [one.code for one in again]


@pytest.mark.parametrize("status", [RunStatus.INFRASTRUCTURE_FAILED, RunStatus.CANCELLED])
def test_a_lost_run_of_a_seed_does_not_stop_the_campaign(status: RunStatus) -> None:
    lost = seeds_that(status=status, failure=RunFailure(cause="worker_lost", message="lost"))
    journal = MemoryJournal()
    state = conduct(search_of(climber()), Computed(work=lost), journal, try_seeds=True)
    assert state is CampaignState.FINISHED
    assert not journal.seed_runs()


def test_an_ads_that_fails_on_the_seed_is_told_apart() -> None:
    failure = RunFailure(cause="agent_raised", message="KeyError: 'lidar'")
    broken = seeds_that(status=RunStatus.AGENT_FAILED, failure=failure)
    warnings: list[CampaignWarning] = []
    conduct(
        search_of(climber()),
        Computed(work=broken),
        MemoryJournal(),
        try_seeds=True,
        watcher=Watcher(on_warning=warnings.append),
    )
    (warning,) = [one for one in warnings if one.code is WarningCode.SEED_FAILS]
    assert "the ADS itself failed (agent_raised: KeyError: 'lidar')" in warning.message


def test_of_many_seeds_the_first_are_run_and_named() -> None:
    count = MOST_SEEDS + 5
    search = search_of(
        climber(),
        parts=tuple(part_of(climber(seed), Values()) for seed in range(count)),
        seed_names=tuple(f"seed {n}" for n in range(count)),
    )
    journal, evaluator = MemoryJournal(), Computed(slots=3, work=COLLIDING)
    conduct(search, evaluator, journal, try_seeds=True)
    assert [run.name for run in journal.seed_runs()] == [f"seed {n}" for n in range(MOST_SEEDS)]
    assert evaluator.submitted[:MOST_SEEDS] == [-1 - n for n in range(MOST_SEEDS)]


def test_each_kind_of_warning_is_given_once() -> None:
    def always(spec: RunSpec) -> RunReport:
        verdict = violated("collision", 1.0, at_fault=True)
        return RunReport(run_id=spec.run_id, status=RunStatus.FINISHED, verdicts=(verdict,))

    warnings: list[tuple[CampaignWarning, int]] = []
    told: list[int] = []
    conduct(
        search_of(climber()),
        Computed(work=always),
        MemoryJournal(),
        confirm=False,
        watcher=Watcher(
            on_told=lambda one: told.append(one.record.number),
            on_warning=lambda one: warnings.append((one, len(told))),
        ),
    )
    ((warning, seen),) = warnings
    assert warning.code is WarningCode.ALL_FAIL
    assert warning.message.startswith("10 of 10 simulations fail")
    # At once, not at the end.
    assert seen < 20 < len(told)
