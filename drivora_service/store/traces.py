"""The locations of trace files.

Those of runs are ``traces/ab/<run id>.parquet``, spread by the end of the id; those of the failures
of a campaign are ``campaigns/<campaign id>/traces/<name>``.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path


class TraceFolder:
    """The folder of all traces."""

    def __init__(self, root: Path) -> None:
        self.root = root

    def path(self, run_id: str) -> Path:
        """Returns the path of the trace of a run, which may not exist."""
        return self.root / run_id[-2:] / f"{run_id}.parquet"

    def prepare(self, run_id: str) -> str:
        """Makes the folder of a run's trace; returns the trace's path.

        Removes the trace of an earlier attempt, which is not that of the next one.
        """
        path = self.path(run_id)
        path.unlink(missing_ok=True)
        path.parent.mkdir(parents=True, exist_ok=True)
        return str(path)

    def run_ids(self) -> Iterator[str]:
        """Yields the ids of all runs that have a trace file."""
        for path in sorted(self.root.glob("??/*.parquet")):
            yield path.stem

    def run_ids_by_folder(self) -> Iterator[tuple[str, ...]]:
        """Yields the same ids, one folder at a time."""
        for folder in sorted(self.root.glob("??")):
            yield tuple(sorted(path.stem for path in folder.glob("*.parquet")))


class CampaignTraces:
    """The traces of the failures of all campaigns."""

    def __init__(self, root: Path) -> None:
        """Takes the folder of all campaigns."""
        self.root = root

    def folder(self, campaign_id: str) -> Path:
        """Returns the folder of a campaign's traces."""
        return self.root / campaign_id / "traces"

    def path(self, campaign_id: str, name: str) -> Path:
        """Returns the path of the trace ``name`` of a failure."""
        return self.folder(campaign_id) / name
