"""The progress of a study on a terminal."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from rich.console import Console, Group
from rich.live import Live
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.text import Text

from drivora_service.cli.campaigns.campaign_display import duration
from drivora_service.cli.campaigns.campaign_warning_text import warning_line
from drivora_service.cli.terminal.log_pace import LogPace
from drivora_service.cli.terminal.output import note
from drivora_service.store.campaigns.campaign_records import CampaignState
from drivora_service.visible_text import visible_text

if TYPE_CHECKING:
    from drivora_service.api.schemas.studies import Study
    from drivora_service.store.campaigns.campaign_warnings import WarningCode


class StudyDisplay:
    """A progress bar of all simulations, and a line of counts below it."""

    def __init__(
        self,
        study: Study,
        warn: Callable[[str], None] = lambda _line: None,
        *,
        in_lines: bool = False,
    ) -> None:
        """Creates the display of a study with the simulations that it has already.

        Args:
            study: The study.
            warn: Prints a line above the display.
            in_lines: Whether to print lines now and then, where a bar is printed at the end only.
        """
        self._log_pace = LogPace() if in_lines else None
        self._bar = Progress(
            BarColumn(bar_width=30),
            TextColumn("{task.completed}/{task.total} simulations"),
            TimeElapsedColumn(),
            TextColumn("{task.fields[pace]}"),
        )
        self._task = self._bar.add_task("", total=study.budget, pace="")
        self._found = Text()
        self._warn = warn
        self._warned: set[tuple[WarningCode, str]] = set()
        self._begun, self._before = time.monotonic(), study.simulations
        self.show(study)

    def __rich__(self) -> Group:
        """Returns the bar and the line."""
        return Group(self._bar, self._found)

    def show(self, study: Study) -> None:
        """Shows the progress of a study."""
        pace = self._pace(study)
        self._bar.update(self._task, completed=study.simulations, pace=pace)
        counts, states = study.counts, study.campaigns
        parts = [
            f"campaigns {states.get(CampaignState.FINISHED, 0)}/{sum(states.values())}, "
            f"{states.get(CampaignState.RUNNING, 0)} running",
            f"failing {counts.violating}: {counts.at_fault} at fault, "
            f"{counts.avoidable or 0} avoidable",
            f"invalid {counts.invalid}",
        ]
        if counts.failed:
            parts.append(f"without a result {counts.failed}")
        if states.get(CampaignState.FAILED):
            parts.append(f"campaigns failed {states[CampaignState.FAILED]}")
        self._found.plain = " · ".join(parts)
        for warning in study.warnings:
            # The numbers in a message change; the scene at its beginning does not.
            known = (warning.code, warning.message.partition(": ")[0])
            if known not in self._warned:
                self._warned.add(known)
                self._warn(warning_line(warning))
        if self._log_pace is not None and self._log_pace.is_due():
            done = f"{study.simulations}/{study.budget} simulations"
            note(f"{done}{', ' + pace if pace else ''}: {self._found.plain}")

    def _pace(self, study: Study) -> str:
        """Returns the rate since this display began, and the time left at that rate."""
        made, seconds = study.simulations - self._before, time.monotonic() - self._begun
        if made <= 0 or seconds <= 0.0:
            return ""
        rate = made / seconds
        return f"{rate:.1f}/s, {duration((study.budget - study.simulations) / rate)} left"


@contextmanager
def study_display(study: Study) -> Iterator[StudyDisplay]:
    """Shows a study on standard error while it runs."""
    console = Console(stderr=True)
    display = StudyDisplay(
        study,
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
