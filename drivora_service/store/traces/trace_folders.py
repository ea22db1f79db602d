"""The places of trace files, in folders or in a storage of objects.

Those of runs are ``traces/ab/<run id>.parquet``, spread by the end of the id, and
``traces/ab/<run id>/<attempt>/<run id>.parquet`` of an attempt after the first: a worker that was
taken for dead may still write. The trace of a run is that of the attempt that ended it. Those of
the failures of a campaign are ``campaigns/<campaign id>/traces/<name>``. A trace has an *address*,
to which a worker writes it, and a *path*, at which it can be read on this machine.
"""

from __future__ import annotations

import contextlib
import os
import shutil
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Protocol

from drivora_service.observations.trace_files.stored_trace import find_file


class RunTraces(Protocol):
    """All traces of runs."""

    @property
    def place(self) -> str:
        """Where they are, for messages."""

    def address(self, run_id: str, attempt: int = 1) -> str:
        """Returns where a worker writes the trace of an attempt at a run."""

    def prepare(self, run_id: str, attempt: int = 1) -> str:
        """Makes room for the trace of an attempt, and returns its address.

        The trace of an earlier attempt is not that of this one, nor is that of a later one touched.

        Raises:
            OSError: Nothing can be written there.
        """

    def path(self, run_id: str, attempt: int = 1) -> Path:
        """Returns the path of the trace of an attempt, which may not exist.

        Raises:
            OSError: The storage does not answer.
        """

    def modification_time(self, run_id: str) -> float:
        """Returns when the last trace of a run was written, in seconds since 1970.

        Raises:
            FileNotFoundError: There is none.
        """

    def remove(self, run_id: str) -> int:
        """Removes the traces of all attempts at a run; returns their size in bytes.

        Raises:
            FileNotFoundError: There is none.
        """

    def run_ids_by_folder(self) -> Iterator[tuple[str, ...]]:
        """Yields the ids of all runs that have a trace, one folder at a time."""


class FailureTraces(Protocol):
    """The traces of the failures of all campaigns."""

    def address(self, campaign_id: str, name: str) -> str:
        """Returns where a worker writes the trace ``name`` of a failure."""

    def path(self, campaign_id: str, name: str) -> Path:
        """Returns the path of the trace of a failure, which may not exist."""

    def names(self, campaign_id: str) -> tuple[str, ...]:
        """Returns the names of the traces of a campaign."""

    def remove(self, campaign_id: str, name: str) -> int:
        """Removes a trace; returns its size in bytes."""

    def take(self, run: str, address: str) -> None:
        """Stores the trace of a run as that of a failure, too, unless it was removed meanwhile.

        Args:
            run: Address of the trace of the run.
            address: That of the trace of the failure.
        """


class TraceFolder:
    """A folder of a file system; see ``RunTraces``."""

    def __init__(self, root: Path) -> None:
        self.root = root

    @property
    def place(self) -> str:
        """The folder."""
        return str(self.root)

    def address(self, run_id: str, attempt: int = 1) -> str:
        """Returns the path of the trace of an attempt, absolute."""
        return str(self._file(run_id, attempt).absolute())

    def prepare(self, run_id: str, attempt: int = 1) -> str:
        """Creates the folder of an attempt's trace, and removes those of attempts before it."""
        file = self._file(run_id, attempt)
        for number in self._attempts(run_id):
            earlier = self._file(run_id, number)
            if number <= attempt:
                earlier.unlink(missing_ok=True)
            if 1 < number < attempt:
                with contextlib.suppress(OSError):
                    earlier.parent.rmdir()
        file.parent.mkdir(parents=True, exist_ok=True)
        return self.address(run_id, attempt)

    def path(self, run_id: str, attempt: int = 1) -> Path:
        """Returns the path of the trace of an attempt, which may not exist."""
        file = self._file(run_id, attempt)
        # Earlier versions of Drivora, and backups, have one place for all attempts.
        is_there = attempt == 1 or not find_file(file).is_missing
        return file if is_there else self._file(run_id, 1)

    def modification_time(self, run_id: str) -> float:
        """Returns when the last trace of a run was written."""
        return max(file.stat().st_mtime for file in self._files(run_id))

    def remove(self, run_id: str) -> int:
        """Removes the traces of all attempts at a run; returns their size in bytes."""
        try:
            return sum(map(_remove_file, self._files(run_id)))
        finally:
            shutil.rmtree(self._later_folder(run_id), ignore_errors=True)

    def run_ids_by_folder(self) -> Iterator[tuple[str, ...]]:
        """Yields the ids of all runs that have a trace, one folder at a time."""
        for folder in sorted(filter(Path.is_dir, self.root.glob("??"))):
            files = {path.stem for path in folder.glob("*.parquet")}
            yield tuple(sorted(files | {path.parts[-3] for path in folder.glob("*/*/*.parquet")}))

    def _file(self, run_id: str, attempt: int) -> Path:
        later = self._later_folder(run_id)
        folder = later.parent if attempt == 1 else later / str(attempt)
        return folder / f"{run_id}.parquet"

    def _files(self, run_id: str) -> tuple[Path, ...]:
        """Returns the traces of all attempts; the place of the first one if there is none."""
        files = [self._file(run_id, number) for number in self._attempts(run_id)]
        return tuple(filter(Path.is_file, files)) or (self._file(run_id, 1),)

    def _attempts(self, run_id: str) -> tuple[int, ...]:
        """Returns the numbers of the attempts that may have a trace."""
        try:
            folders = list(self._later_folder(run_id).iterdir())
        except (FileNotFoundError, NotADirectoryError):
            return (1,)
        return (1, *later_attempts(folder.name for folder in folders))

    def _later_folder(self, run_id: str) -> Path:
        return self.root / run_id[-2:] / run_id


class CampaignTraces:
    """The folders of campaigns in a file system; see ``FailureTraces``."""

    def __init__(self, root: Path) -> None:
        """Takes the folder of all campaigns."""
        self.root = root

    def address(self, campaign_id: str, name: str) -> str:
        """Returns the path of the trace ``name`` of a failure, absolute."""
        return str(self.path(campaign_id, name).absolute())

    def path(self, campaign_id: str, name: str) -> Path:
        """Returns the path of the trace ``name`` of a failure."""
        return self.root / campaign_id / "traces" / name

    def names(self, campaign_id: str) -> tuple[str, ...]:
        """Returns the names of the traces of a campaign."""
        folder = self.root / campaign_id / "traces"
        return tuple(sorted(path.name for path in folder.glob("*.parquet")))

    def remove(self, campaign_id: str, name: str) -> int:
        """Removes a trace; returns its size in bytes."""
        return _remove_file(self.path(campaign_id, name))

    def take(self, run: str, address: str) -> None:
        """Links a trace under a second name, or copies it where links are impossible."""
        written, wanted = Path(run), Path(address)
        wanted.parent.mkdir(parents=True, exist_ok=True)
        wanted.unlink(missing_ok=True)
        with contextlib.suppress(FileNotFoundError):
            try:
                os.link(written, wanted)
            except OSError:
                shutil.copyfile(written, wanted)


def run_ids(traces: RunTraces) -> Iterator[str]:
    """Yields the ids of all runs that have a trace."""
    for some in traces.run_ids_by_folder():
        yield from some


def later_attempts(names: Iterable[str]) -> tuple[int, ...]:
    """Returns the numbers of attempts by the names of their folders."""
    return tuple(sorted(int(name) for name in names if name.isdecimal()))


def _remove_file(path: Path) -> int:
    size = path.stat().st_size
    path.unlink()
    return size
