"""Batches as commands print them."""

from __future__ import annotations

from collections.abc import Sequence

from drivora_service.api.schemas.batches import Batch
from drivora_service.cli.terminal.output import print_prose, print_table, say


def print_batches(batches: Sequence[Batch]) -> None:
    """Prints a row a batch."""
    print_table(
        "",
        ("id", "name", "state", "runs", "failing", "created"),
        (
            (
                batch.id,
                batch.name or "-",
                _state(batch),
                str(batch.size),
                str(batch.failing_runs),
                f"{batch.created_at.astimezone():%Y-%m-%d %H:%M:%S}",
            )
            for batch in batches
        ),
        cut=("name",),
    )


def print_batch(batch: Batch) -> None:
    """Prints one batch, with what counts as a failure of its runs."""
    print_batches((batch,))
    counts = ", ".join(
        f"{number} {status.replace('_', ' ')}" for status, number in batch.counts.items() if number
    )
    say(f"Runs: {counts or 'none'}; with a violation: {batch.violated_runs}")
    if batch.definition is not None:
        print_prose(f"Failures are {batch.definition.words}")


def _state(batch: Batch) -> str:
    """Returns the state of a batch; of one that is open, whether its runs have ended."""
    return "done" if batch.done else str(batch.state)
