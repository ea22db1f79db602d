"""The commands as the parser has them, each with ``-v`` and with examples in its help."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from drivora_service.cli.command_examples import EXAMPLES
from drivora_service.cli.exit_codes import EPILOG

_VERBOSE = "--verbose"


def complete_commands(root: Any) -> None:
    """Adds the option ``-v`` of the root and the examples to every command.

    Does nothing to a tree that has been completed.

    Args:
        root: The group of all commands, as Typer makes it.
    """
    verbose = next(option for option in root.params if _VERBOSE in option.opts)
    for words, command in commands_of(root):
        if verbose in command.params:
            return
        command.params.append(verbose)
        command.epilog = _epilog(EXAMPLES.get(words, ()))


def commands_of(group: Any, above: str = "") -> Iterator[tuple[str, Any]]:
    """Yields the words of every command, and the command; of groups only their commands."""
    for name, command in group.commands.items():
        words = f"{above} {name}".strip()
        if hasattr(command, "commands"):
            yield from commands_of(command, words)
        else:
            yield words, command


def _epilog(examples: tuple[str, ...]) -> str:
    if not examples:
        return EPILOG
    # \b: a paragraph whose lines are not joined.
    return "\n".join(["\b", "Examples:", *(f"  {line}" for line in examples), "", EPILOG])
