"""Where trace files lie.

Those of runs are ``traces/ab/<run id>.parquet``, spread by the end of the id; those of the failures
that a campaign has found are ``campaigns/<campaign id>/traces/<name>``.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path


class TraceFolder:
    """The folder of all traces."""

    def __init__(self, root: Path) -> None:
        self.root = root

    def path(self, run_id: str) -> Path:
        """Returns where the trace of a run lies, if it has one."""
        return self.root / run_id[-2:] / f"{run_id}.parquet"

    def prepare(self, run_id: str) -> str:
        """Makes the folder of a run's trace and gives the trace's path.

        The trace of an earlier attempt is removed: it is not that of the attempt that comes.
        """
        path = self.path(run_id)
        path.unlink(missing_ok=True)
        path.parent.mkdir(parents=True, exist_ok=True)
        return str(path)

    def run_ids(self) -> Iterator[str]:
        """Returns the ids of all runs that have a trace file."""
        for path in sorted(self.root.glob("??/*.parquet")):
            yield path.stem

    def run_ids_by_folder(self) -> Iterator[tuple[str, ...]]:
        """Returns the same ids, those of one folder at a time."""
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
        """Returns where the trace of a failure lies, whose record names it."""
        return self.folder(campaign_id) / name
