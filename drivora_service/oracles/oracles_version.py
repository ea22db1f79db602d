"""The version of the oracles by which runs are judged.

Verdicts are stored, and oracles change: a run that was judged before a change keeps its verdicts.
Its report has the version of the oracles that gave them.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

from drivora_service.oracles.laws.law_schema import shipped_laws

ORACLES = "drivora/oracles"
"""Its name among the versions of a run; no package has a name with a slash."""

_ROOMS = ("geometry", "networks", "observations", "oracles")
"""Rooms whose code decides verdicts; the thresholds are in them."""

_LENGTH = 12


@lru_cache(maxsize=1)
def oracles_version() -> str:
    """Returns the version of this installation's oracles, a hash of the code and laws that judge.

    A hash cannot be forgotten, unlike a number that each change has to raise. It also differs after
    changes by which no verdict changes: whether one did, only judging again shows.
    """
    package = Path(__file__).parents[1]
    folders = (*((package / room, "*.py") for room in _ROOMS), (shipped_laws(), "*.yaml"))
    digest = hashlib.sha256()
    for folder, pattern in folders:
        for path in sorted(folder.rglob(pattern)):
            name = f"{folder.name}/{path.relative_to(folder).as_posix()}"
            digest.update(f"{name}\0".encode() + path.read_bytes() + b"\0")
    return digest.hexdigest()[:_LENGTH]


def judged_by_current(versions: Mapping[str, Any]) -> bool:
    """Returns whether this installation's oracles judged a run with these versions."""
    return versions.get(ORACLES) == oracles_version()
