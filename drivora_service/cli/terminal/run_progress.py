"""The progress of runs on standard error."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

from drivora_service.cli.terminal.log_pace import LogPace
from drivora_service.cli.terminal.output import say
from drivora_service.visible_text import visible_text


@contextmanager
def run_progress(names: Sequence[str], *, total: int) -> Iterator[Callable[[str], None]]:
    """Shows a bar for each name; yields a function that counts one more ended run of a name.

    Args:
        names: What the runs belong to, each once.
        total: Number of runs of each name.
    """
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
    )
    console, pace = Console(stderr=True), LogPace()
    ended = dict.fromkeys(names, 0)
    with Progress(*columns, console=console) as progress:
        tasks = {name: progress.add_task(visible_text(name), total=total) for name in names}

        def count(name: str) -> None:
            progress.advance(tasks[name])
            ended[name] += 1
            # Without a terminal, the bar is printed at the end only.
            if not console.is_terminal and pace.is_due():
                parts = [f"{name} {done}/{total}" for name, done in ended.items()]
                say(", ".join(parts), is_error=True)

        yield count
