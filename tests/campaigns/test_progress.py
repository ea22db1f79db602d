from __future__ import annotations

import itertools

import pytest

from drivora_service.campaigns.engine import Told
from drivora_service.campaigns.journal import MemoryJournal
from drivora_service.campaigns.progress import ProgressMeter
from drivora_service.search.tester import EvaluationStatus
from drivora_service.store.campaign_records import Confirmation
from tests.campaigns.analytic import run


def test_counts_and_best_are_those_of_the_journal() -> None:
    journal = MemoryJournal()
    meter = ProgressMeter(60)
    run(journal, on_told=meter.note)
    records = list(journal.evaluations())
    now = meter.progress()
    statuses = [record.status for record in records]
    assert now.counts.evaluations == len(records)
    assert now.counts.simulations == 60
    assert now.counts.invalid == statuses.count(EvaluationStatus.INVALID)
    assert now.counts.violating == sum(bool(record.violations) for record in records)
    assert now.kinds == 1
    least = min(
        record.report.measurement.objectives["min_gap"] or 0.0
        for record in records
        if record.report.measurement is not None
    )
    assert now.best == ("min_gap", least)


def test_the_rate_is_of_simulations_and_says_what_is_left() -> None:
    ticks = itertools.count(0.0, 0.5)
    meter = ProgressMeter(60, clock=lambda: next(ticks))
    left: list[float | None] = []

    def watch(told: Told) -> None:
        meter.note(told)
        left.append(meter.progress().left_s)

    journal = MemoryJournal()
    run(journal, budget=30, on_told=watch)
    assert meter.progress().rate == pytest.approx(2.0)
    assert left[0] is None
    assert left[-1] == pytest.approx(15.0)


def test_replayed_evaluations_do_not_count_for_the_rate() -> None:
    whole = MemoryJournal()
    run(whole)
    meter = ProgressMeter(60)
    run(whole, on_told=meter.note)
    assert meter.progress().counts.simulations == 60
    assert meter.progress().rate is None


def test_confirmations_are_counted() -> None:
    meter = ProgressMeter(10)
    meter.note_again(3, Confirmation.CONFIRMED)
    meter.note_again(4, Confirmation.FLAKY)
    meter.note_again(5, Confirmation.CONFIRMED)
    now = meter.progress()
    assert (now.confirmed, now.flaky) == (2, 1)
