"""Exit codes of commands; scripts rely on them."""

from __future__ import annotations

from enum import IntEnum


class ExitCode(IntEnum):
    """The exit code of a command."""

    DONE = 0
    GATE_FAILED = 1
    NOT_MINIMAL = 1
    """The budget ended before the scenario was minimal; the same code as a gate that failed."""
    USAGE_ERROR = 2
    NOT_DONE = 3
    INTERRUPTED = 130
    """As of a process that the signal of Ctrl-C has ended."""


EPILOG = (
    "Exit codes: 0 done · 1 a gate failed · 2 usage error · 3 the work could not be done · "
    "130 interrupted. Settings are read from DRIVORA_… variables."
)
