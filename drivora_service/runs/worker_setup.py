"""What every worker is told once, when it starts."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkerSetup:
    """Where a worker finds what documents only name.

    It lies apart from the performing of runs so that the process that owns the workers can make one
    without loading the simulator.
    """

    shipped_networks: Path
    imported_networks: Path | None = None
