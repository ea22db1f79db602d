"""A campaign that runs, shown on a terminal."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console, Group
from rich.live import Live
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.text import Text

from drivora_service.campaigns import progress as campaign_progress
from drivora_service.campaigns.engine import Told
from drivora_service.cli.output import number
from drivora_service.store.campaign_records import Confirmation


class CampaignDisplay:
    """A bar and a line below it that follow the work."""

    def __init__(self, budget: int) -> None:
        """Begins at the beginning."""
        self._meter = campaign_progress.ProgressMeter(budget)
        self._bar = Progress(
            BarColumn(bar_width=30),
            TextColumn("{task.completed}/{task.total} simulations"),
            TimeElapsedColumn(),
            TextColumn("{task.fields[pace]}"),
        )
        self._task = self._bar.add_task("", total=budget, pace="")
        self._found = Text()

    def __rich__(self) -> Group:
        """Returns what is to be seen."""
        return Group(self._bar, self._found)

    def on_told(self, told: Told) -> None:
        """Shows an evaluation."""
        self._meter.note(told)
        self.show(self._meter.progress())

    def on_confirmed(self, number_: int, confirmation: Confirmation) -> None:
        """Shows that a failing scenario was run again."""
        self._meter.note_again(number_, confirmation)
        self.show(self._meter.progress())

    def show(self, now: campaign_progress.Progress) -> None:
        """Shows how a campaign stands."""
        left = "" if now.left_s is None else f", {_duration(now.left_s)} left"
        pace = "" if now.rate is None else f"{now.rate:.1f}/s{left}"
        self._bar.update(self._task, completed=now.counts.simulations, pace=pace)
        self._found.plain = _found(now)


@contextmanager
def campaign_display(budget: int) -> Iterator[CampaignDisplay]:
    """Shows a campaign on standard error while it runs."""
    display, console = CampaignDisplay(budget), Console(stderr=True)
    with Live(display, console=console, refresh_per_second=4):
        yield display
    if not console.is_terminal:
        # What follows would else stand in the same line.
        console.line()


def _found(now: campaign_progress.Progress) -> str:
    counts = now.counts
    parts = [
        f"failing {counts.violating}: {now.kinds} kinds, {counts.at_fault} at fault, "
        f"{counts.avoidable} avoidable",
        f"invalid {counts.invalid}",
    ]
    if counts.failed:
        parts.append(f"without a result {counts.failed}")
    if now.best is not None:
        parts.append(f"best {now.best[0].replace('_', ' ')} {number(now.best[1], 3)}")
    if now.confirmed or now.flaky:
        parts.append(f"confirmed {now.confirmed}, flaky {now.flaky}")
    return " · ".join(parts)


def _duration(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{rest:02d}" if hours else f"{minutes}:{rest:02d}"
