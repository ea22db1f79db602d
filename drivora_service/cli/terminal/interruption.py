"""What a command says when it is interrupted (Ctrl-C, SIGTERM): one line."""

from __future__ import annotations

from drivora_service.cli.terminal.output import note

_said: list[str] = []
"""What was said; a command is interrupted once."""


def say_interrupted(kept: str) -> None:
    """Prints that the command was interrupted.

    Args:
        kept: What has been kept, and how to go on.
    """
    _said.append(kept)
    note(f"interrupted: {kept}")


def end_interrupted() -> None:
    """Prints that the command was interrupted, unless the command itself has said more."""
    if not _said:
        say_interrupted("what it has stored is kept; give the same command again to go on")
