"""``-v``: whether the tracebacks of errors are printed."""

from __future__ import annotations

import logging
import traceback

from drivora_service.cli.terminal.output import note

_asked: list[bool] = []
"""Not empty once a command of this process was asked for them."""

_PLUGINS = "drivora_service.plugin_table"
"""Logs the tracebacks of plug-ins that cannot be loaded."""

ADVICE = "add -v for the traceback"


def set_verbose(wanted: bool) -> None:
    """Sets what ``-v`` asks for; without it, nothing changes."""
    if wanted:
        _asked.append(wanted)
        # What else the commands log at this level is of no use beside their results.
        logging.getLogger(_PLUGINS).setLevel(logging.INFO)


def is_verbose() -> bool:
    """Returns whether tracebacks are wanted."""
    return bool(_asked)


def print_traceback(error: BaseException) -> None:
    """Prints the traceback of an error and its causes, if that is wanted.

    An error of a plug-in has the end of its traceback as text, if it comes from another process.
    """
    if not is_verbose():
        return
    log = getattr(error, "log", "")
    note(log.rstrip() if log else "".join(traceback.format_exception(error)).rstrip())


def print_plugin_log(log: str) -> None:
    """Prints the traceback of a plug-in, or how to see it."""
    if log:
        note(log.rstrip() if is_verbose() else ADVICE)
