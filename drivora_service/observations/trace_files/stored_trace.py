"""The trace file of a stored run, and the errors of one that is not what was recorded."""

from __future__ import annotations

import os
import stat
from dataclasses import dataclass
from pathlib import Path

from drivora_service.errors import TraceDamaged


@dataclass(frozen=True, slots=True, kw_only=True)
class StoredTrace:
    """The trace file of a stored run.

    Attributes:
        run_id: Id of the run.
        path: The file.
        sha256: Hash that is stored of the run.
    """

    run_id: str
    path: Path
    sha256: str


@dataclass(frozen=True, slots=True)
class FoundFile:
    """What there is at the place of a trace file.

    Attributes:
        state: Of the file itself, behind links; ``None`` if there is no regular file.
        fault: In words why it cannot be read, after the name of the file; "" of a regular file.
        is_missing: Whether there is nothing.
    """

    state: os.stat_result | None = None
    fault: str = ""
    is_missing: bool = False


def find_file(path: Path) -> FoundFile:
    """Returns what there is at the place of a trace file; never fails, and never waits.

    A pipe would keep its reader waiting; a folder or a file without rights is not missing.
    """
    try:
        state = path.stat()
    except (FileNotFoundError, NotADirectoryError):
        return FoundFile(fault="does not exist", is_missing=True)
    except OSError as error:
        return FoundFile(fault=f"cannot be read: {error.strerror or error}")
    if stat.S_ISREG(state.st_mode):
        return FoundFile(state)
    kind = "a folder" if stat.S_ISDIR(state.st_mode) else "a pipe, a socket or a device"
    return FoundFile(fault=f"cannot be read: it is {kind}, not a file")


def make_missing_error(stored: StoredTrace) -> TraceDamaged:
    """Returns the error of a trace file that does not exist."""
    what = f"is missing: a trace with the hash {stored.sha256} was recorded"
    return make_damage_error(stored, "trace_missing", what)


def make_damage_error(stored: StoredTrace, code: str, what: str) -> TraceDamaged:
    """Returns the error of a trace file that cannot be used.

    Args:
        stored: The file.
        code: One of the codes of ``TraceDamaged``.
        what: What was found and expected, after the name of the file.
    """
    return TraceDamaged(
        f"run {stored.run_id}: its trace file {stored.path.name} {what}. Restore the file from a "
        f"backup, or give `drivora replay {stored.run_id}`: it runs the scenario again, which "
        "records a new trace",
        code=code,
        file=str(stored.path),
    )
