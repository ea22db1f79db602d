"""The progress of a campaign: what its numbers count."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import cast

import pytest
from rich.console import Console

from drivora_service.api.documentation.recorded_examples import read_recorded
from drivora_service.api.schemas.campaigns import Campaign, Failure
from drivora_service.cli.campaigns.campaign_display import CampaignDisplay, Repeated
from drivora_service.cli.campaigns.campaign_output import print_campaign
from drivora_service.cli.campaigns.campaign_running import RepeatedCounter
from drivora_service.client import Client
from drivora_service.oracles.verdict import Outcome, Verdict
from drivora_service.shapes import adapter
from drivora_service.store.campaigns.campaign_records import (
    CampaignCounts,
    Confirmation,
    FailureKind,
)


def failure(evaluation: int, kind: str, confirmation: Confirmation) -> Failure:
    return Failure(
        evaluation=evaluation,
        place=0,
        kind=kind,
        confirmation=confirmation,
        verdict=Verdict(oracle=kind, ego="ego", outcome=Outcome.VIOLATED, message=""),
        scenario_url="",
        observations_url="",
    )


FAILURES = (
    # Two kinds in one simulation.
    failure(3, "collision", Confirmation.CONFIRMED),
    failure(3, "red_light", Confirmation.CONFIRMED),
    failure(5, "collision", Confirmation.CONFIRMED),
    failure(8, "red_light", Confirmation.FLAKY),
    failure(9, "collision", Confirmation.OPEN),
)


class Service:
    """The failures of a campaign, and how often they were asked for."""

    def __init__(self, failures: tuple[Failure, ...]) -> None:
        self.failures_now = failures
        self.asked = 0

    def failures(self, _campaign_id: str) -> Iterator[Failure]:
        self.asked += 1
        return iter(self.failures_now)


def campaign_with(failures: tuple[Failure, ...]) -> Campaign:
    campaign: Campaign = adapter(Campaign).validate_python(
        read_recorded("recorded:finished-campaign.json")
    )

    def kind_of(name: str) -> FailureKind:
        ends = [one.confirmation for one in failures if one.kind == name]
        return FailureKind(
            kind=name,
            failures=len(ends),
            violations=len(ends),
            at_fault=0,
            avoidable=0,
            confirmed=ends.count(Confirmation.CONFIRMED),
            flaky=ends.count(Confirmation.FLAKY),
            first=0,
            groups=None,
        )

    names = dict.fromkeys(one.kind for one in failures)
    return replace(campaign, kinds=tuple(map(kind_of, names)))


def count(service: Service, counter: RepeatedCounter) -> Repeated:
    return counter.count(campaign_with(service.failures_now))


def test_a_simulation_of_two_kinds_is_confirmed_once() -> None:
    service = Service(FAILURES)
    counter = RepeatedCounter(cast("Client", service))
    assert count(service, counter) == Repeated(confirmed=2, flaky=1)
    # What has not changed is not read again.
    assert count(service, counter) == Repeated(confirmed=2, flaky=1)
    assert service.asked == 1
    service.failures_now = (*FAILURES[:-1], failure(9, "collision", Confirmation.CONFIRMED))
    assert count(service, counter) == Repeated(confirmed=3, flaky=1)


def test_failures_of_one_kind_and_open_ones_need_not_be_read() -> None:
    service = Service((FAILURES[0], FAILURES[2]))
    counter = RepeatedCounter(cast("Client", service))
    assert count(service, counter) == Repeated(confirmed=2)
    service.failures_now = tuple(replace(one, confirmation=Confirmation.OPEN) for one in FAILURES)
    assert count(service, counter) == Repeated()
    assert service.asked == 0


def test_the_line_below_the_bar_has_these_numbers() -> None:
    display, console = CampaignDisplay(40), Console(width=200)
    display.show(campaign_with(FAILURES), Repeated(confirmed=2, flaky=1))
    with console.capture() as printed:
        console.print(display)
    assert "· confirmed 2, flaky 1" in printed.get()


def test_each_kind_of_warning_is_printed_once_above_the_bar() -> None:
    lines: list[str] = []
    display, campaign = CampaignDisplay(40, lines.append), campaign_with(())
    few = replace(campaign, counts=CampaignCounts(judged=9, violating=9), seed_runs=())
    display.show(few, Repeated())
    assert not lines
    for judged in (10, 12, 15):
        counts = CampaignCounts(judged=judged, violating=judged)
        display.show(replace(few, counts=counts), Repeated())
    (line,) = lines
    assert line.startswith("warning: 10 of 10 simulations fail. ")
    assert line.endswith(" See docs/how-to/when-everything-or-nothing-fails.md#everything-fails")


def test_the_warnings_of_a_campaign_are_printed_with_what_to_do(
    capsys: pytest.CaptureFixture[str],
) -> None:
    counts = CampaignCounts(judged=300)
    print_campaign(replace(campaign_with(()), counts=counts, seed_runs=()))
    printed = capsys.readouterr().out
    assert "  Warning: No failure in 300 simulations: if they were drawn at random, at" in printed
    assert "    See docs/how-to/when-everything-or-nothing-fails.md#nothing-fails\n" in printed
