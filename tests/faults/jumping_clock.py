"""The wall clock of the server jumps by what a file says.

Python runs this file in every process of the service, as ``sitecustomize``; it changes the server
alone. What it covers: ``time.time``, ``time.time_ns`` and the current time of ``datetime`` in the
server's process. Compiled code, file times, the database's own clock and all other processes keep
the system's; ``time.monotonic`` does not jump with a system's clock either.
"""

from __future__ import annotations

import datetime
import os
import sys
import time
from datetime import datetime as _datetime
from pathlib import Path
from typing import Any

VARIABLE = "FAULTS_CLOCK_FILE"
"""Environment variable that names the file with the seconds of the jump."""

_time, _time_ns = time.time, time.time_ns


def jump_s() -> float:
    """Returns the seconds by which the clock is wrong."""
    try:
        return float(Path(os.environ[VARIABLE]).read_text() or 0.0)
    except (OSError, KeyError, ValueError):
        return 0.0


class _Kind(type):
    def __instancecheck__(cls, value: object) -> bool:
        return isinstance(value, _datetime)

    def __subclasscheck__(cls, kind: type) -> bool:
        return issubclass(kind, _datetime)


class _JumpingDatetime(_datetime, metaclass=_Kind):
    """Makes real datetimes; the current time is wrong."""

    def __new__(cls, *values: Any, **named: Any) -> Any:
        return _datetime(*values, **named)

    @classmethod
    def now(cls, tz: datetime.tzinfo | None = None) -> Any:
        return _datetime.now(tz) + datetime.timedelta(seconds=jump_s())


def install() -> None:
    """Puts the wrong clock in the place of the right one."""
    time.time = lambda: _time() + jump_s()
    time.time_ns = lambda: _time_ns() + int(jump_s() * 1e9)
    datetime.datetime = _JumpingDatetime  # type: ignore[misc] # everything that is imported later
    # sees this one


if VARIABLE in os.environ and "serve" in sys.orig_argv:
    install()
