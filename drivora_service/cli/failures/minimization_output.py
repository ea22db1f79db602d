"""Minimisations on a terminal: their progress, and what became smaller."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from drivora_service.cli.terminal.output import number, print_table, say
from drivora_service.oracles.verdicts.accountability import IN_WORDS

if TYPE_CHECKING:
    from drivora_service.api.schemas.minimizations import Minimization
    from drivora_service.store.minimizations.minimization_records import ScenarioSize


@contextmanager
def minimization_display(
    minimization: Minimization,
) -> Iterator[Callable[[Minimization], None]]:
    """Shows a minimisation on standard error; yields a function that shows its progress."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    console = Console(stderr=True)
    columns = (
        BarColumn(bar_width=20),
        TextColumn("{task.completed}/{task.total} simulations"),
        TimeElapsedColumn(),
        TextColumn("{task.description}", markup=False),
    )
    with Progress(*columns, console=console) as progress:
        task = progress.add_task("", total=minimization.budget)

        def show(now: Minimization) -> None:
            progress.update(task, completed=now.decided, description=_stage(now))

        yield show


def print_minimization(minimization: Minimization) -> None:
    """Prints what became smaller, side by side."""
    before, after = minimization.before, minimization.after
    if before is None or after is None:
        return
    failure = minimization.failure
    words = IN_WORDS[failure.accountability]
    say(f"{failure.oracle} of {failure.ego}{f', {words}' if words else ''}")
    print_table("", ("", "before", "after"), _rows(before, after))
    for sentence in minimization.removed:
        say(f"  {sentence}")
    tried = "every single reduction was tried" if minimization.one_minimal else "not yet minimal"
    seconds = _seconds(minimization)
    say(
        f"{minimization.simulations} simulations{f' in {seconds:.1f} s' if seconds else ''}; "
        f"{tried}"
    )
    if minimization.minimal_run_id:
        say(f"run {minimization.minimal_run_id}")


def title_of(size: ScenarioSize, name: str) -> str:
    """Returns a line with the size of a scenario, for a picture."""
    return (
        f"{name}: {size.actors} actors, {size.waypoints} waypoints, {size.route_m:.0f} m of "
        f"routes, {size.sim_time_s:.1f} s"
    )


def _rows(before: ScenarioSize, after: ScenarioSize) -> list[tuple[str, str, str]]:
    counts = {
        "egos": "egos",
        "NPC vehicles": "vehicles",
        "walkers": "walkers",
        "obstacles": "obstacles",
        "background traffic": "background",
        "slippery patches": "patches",
        "waypoints": "waypoints",
        "settings": "settings",
        "digits of numbers": "digits",
    }
    rows = [("actors", str(before.actors), str(after.actors))]
    rows += [
        (f"  {name}" if place < 5 else name, str(was), str(getattr(after, field)))
        for place, (name, field) in enumerate(counts.items())
        if (was := getattr(before, field)) or place > 5
    ]
    rows.append(("routes of egos (m)", number(before.route_m), number(after.route_m)))
    rows.append(("simulated time (s)", number(before.sim_time_s), number(after.sim_time_s)))
    return rows


def _stage(minimization: Minimization) -> str:
    size = minimization.after
    so_far = "" if size is None else f", {size.actors} actors"
    return f"{minimization.stage.replace('_', ' ')}{so_far}"


def _seconds(minimization: Minimization) -> float:
    begun, ended = minimization.started_at, minimization.ended_at
    return 0.0 if begun is None or ended is None else (ended - begun).total_seconds()
