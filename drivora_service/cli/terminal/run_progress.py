"""The progress of runs on standard error."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager


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
    with Progress(*columns, console=Console(stderr=True)) as progress:
        tasks = {name: progress.add_task(name, total=total) for name in names}
        yield lambda name: progress.advance(tasks[name])
