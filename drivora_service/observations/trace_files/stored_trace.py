"""The trace file of a stored run, and the errors of one that is not what was recorded."""

from __future__ import annotations

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
        f"run {stored.run_id}: its trace file {stored.path.name} {what}. `drivora replay "
        f"{stored.run_id}` runs its scenario again, which records a new trace",
        code=code,
        file=str(stored.path),
    )
