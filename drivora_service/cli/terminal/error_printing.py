"""Errors that stopped campaigns of this process, as commands print them."""

from __future__ import annotations

from drivora_service.cli.terminal.output import fail, note
from drivora_service.cli.terminal.verbosity import print_plugin_log
from drivora_service.errors import DrivoraError, PluginError, StoreError, WorkersCannotStart


def say_error(error: BaseException) -> None:
    """Prints what the stored message does not tell of the error that stopped a campaign."""
    if isinstance(error, PluginError):
        print_plugin_log(error.log)
    elif isinstance(error, WorkersCannotStart | StoreError):
        # What the database refuses is not stored, nor is what happened before it.
        if isinstance(error.__context__, DrivoraError):
            note(str(error.__context__))
        fail(str(error))
    elif not isinstance(error, DrivoraError):
        fail(f"the campaign was stopped by an error of Drivora: {type(error).__name__}: {error}")


class ErrorPrinter:
    """Prints errors of several campaigns, each message once."""

    def __init__(self) -> None:
        self._said: set[str] = set()

    def __call__(self, error: BaseException) -> None:
        """Prints an error unless its message was printed."""
        if str(error) not in self._said:
            self._said.add(str(error))
            say_error(error)
