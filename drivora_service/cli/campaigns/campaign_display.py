"""The progress of a campaign on a terminal."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rich.console import Console, Group
from rich.live import Live
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.text import Text

from drivora_service.cli.campaigns.campaign_warning_text import warning_line
from drivora_service.cli.terminal.log_pace import LogPace
from drivora_service.cli.terminal.output import note, number
from drivora_service.visible_text import visible_text

if TYPE_CHECKING:
    from drivora_service.api.schemas.campaigns import Campaign
    from drivora_service.store.campaigns.campaign_warnings import WarningCode


@dataclass(frozen=True, slots=True, kw_only=True)
class Repeated:
    """The failing simulations of a campaign that were run again, each once.

    Attributes:
        confirmed: Those that the second run confirmed.
        flaky: Those that it did not.
    """

    confirmed: int = 0
    flaky: int = 0


class CampaignDisplay:
    """A progress bar and a line of counts below it."""

    def __init__(
        self,
        budget: int,
        warn: Callable[[str], None] = lambda _line: None,
        *,
        in_lines: bool = False,
    ) -> None:
        """Creates the display of a campaign without simulations.

        Args:
            budget: Simulations of the campaign.
            warn: Prints a line above the display.
            in_lines: Whether to print lines now and then, where a bar is printed at the end only.
        """
        self._pace = LogPace() if in_lines else None
        self._bar = Progress(
            BarColumn(bar_width=30),
            TextColumn("{task.completed}/{task.total} simulations"),
            TimeElapsedColumn(),
            TextColumn("{task.fields[pace]}"),
        )
        self._task = self._bar.add_task("", total=budget, pace="")
        self._found = Text()
        self._warn = warn
        self._warned: set[WarningCode] = set()

    def __rich__(self) -> Group:
        """Returns the bar and the line."""
        return Group(self._bar, self._found)

    def show(self, campaign: Campaign, repeated: Repeated) -> None:
        """Shows the progress of a campaign, and how many of its failures were repeated."""
        left = "" if campaign.left_s is None else f", {duration(campaign.left_s)} left"
        pace = "" if campaign.rate is None else f"{campaign.rate:.1f}/s{left}"
        self._bar.update(self._task, completed=campaign.simulations, pace=pace)
        self._found.plain = _format_findings(campaign, repeated)
        for warning in campaign.warnings:
            if warning.code not in self._warned:
                self._warned.add(warning.code)
                self._warn(warning_line(warning))
        if self._pace is not None and self._pace.is_due():
            done = f"{campaign.simulations}/{campaign.budget} simulations"
            note(f"{done}{', ' + pace if pace else ''}: {self._found.plain}")


@contextmanager
def campaign_display(budget: int) -> Iterator[CampaignDisplay]:
    """Shows a campaign on standard error while it runs."""
    console = Console(stderr=True)
    display = CampaignDisplay(
        budget,
        lambda line: console.print(Text(visible_text(line)), soft_wrap=True),
        in_lines=not console.is_terminal,
    )
    try:
        with Live(display, console=console, refresh_per_second=4):
            yield display
    finally:
        if not console.is_terminal:
            # The next output would otherwise stand in the same line.
            console.line()


def _format_findings(campaign: Campaign, repeated: Repeated) -> str:
    counts = campaign.counts
    parts = [
        f"failing {counts.violating}: {len(campaign.kinds)} kinds, {counts.at_fault} at fault, "
        f"{counts.avoidable or 0} avoidable",
        f"invalid {counts.invalid}",
    ]
    if counts.apart:
        parts.append(f"others {sum(number for number, _ in counts.apart)}")
    if counts.failed:
        parts.append(f"without a result {counts.failed}")
    for name, best in list(campaign.best.items())[:1]:
        parts.append(f"best {name.replace('_', ' ')} {number(best.value, 3)}")
    if repeated.confirmed or repeated.flaky:
        parts.append(f"confirmed {repeated.confirmed}, flaky {repeated.flaky}")
    return " · ".join(parts)


def duration(seconds: float) -> str:
    """Returns seconds as minutes and seconds, with the hours if there are any."""
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{rest:02d}" if hours else f"{minutes}:{rest:02d}"
