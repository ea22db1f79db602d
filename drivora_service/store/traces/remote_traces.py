"""Traces in a storage that other machines reach, by the file systems of ``fsspec``.

Workers write to it themselves. What is read is copied into a folder of this machine first, which
keeps the newest copies.
"""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from drivora_service.errors import ConfigurationError
from drivora_service.observations.trace_files.trace_storage import is_of_objects
from drivora_service.store.traces.trace_copies import TraceCopies
from drivora_service.store.traces.trace_folders import later_attempts

if TYPE_CHECKING:
    from fsspec import AbstractFileSystem

_MODIFIED = ("LastModified", "mtime", "last_modified", "modified", "created")
"""How file systems name the time at which a file was written."""


class Storage:
    """A folder of a storage, with copies on this machine."""

    def __init__(self, url: str, copies: Path) -> None:
        """Creates the access to a folder; nothing is read or written yet.

        Args:
            url: Address of the folder, such as ``s3://bucket/drivora``.
            copies: Folder of the copies.

        Raises:
            ConfigurationError: No installed package knows such addresses.
        """
        try:
            import fsspec

            # Workers, which are other processes, write what a list that is kept would not have.
            system, root = fsspec.core.url_to_fs(url, use_listings_cache=False)
        except (ImportError, ValueError) as error:
            raise ConfigurationError(
                f"DRIVORA_TRACES_URL: {url.partition('://')[0]!r} cannot be used: {error}; storage "
                "like that of S3 needs the extra `storage`: pip install 'drivora[storage]'"
            ) from error
        self.url = url.rstrip("/")
        self._system: AbstractFileSystem = system
        self._root: str = root.rstrip("/")
        self._copies = TraceCopies(copies)

    def address(self, name: str) -> str:
        """Returns the address of a file, by its name below the folder."""
        return f"{self.url}/{name}"

    def copy_of(self, name: str) -> Path:
        """Returns the path of a copy of a file on this machine.

        It does not exist if there is no such file.

        Raises:
            OSError: The storage does not answer.
        """
        with self._answers():
            try:
                info = self._system.info(self._place(name))
            except FileNotFoundError:
                return self._copies.place_of_none(name)
        if info.get("type", "file") != "file":
            return self._copies.place_of_none(name)
        version = repr(sorted(info.items(), key=str))

        def fetch(part: str) -> None:
            with self._answers():
                self._system.get_file(self._place(name), part)

        try:
            return self._copies.get(
                name, version, fetch, size=info.get("size"), written=_seconds(info)
            )
        except FileNotFoundError:
            return self._copies.place_of_none(name)

    @contextlib.contextmanager
    def _answers(self) -> Iterator[None]:
        """Turns the errors of all storages into one kind; that a file is missing is none of them.

        Raises:
            OSError: The storage does not answer, or refuses.
        """
        try:
            yield
        except FileNotFoundError:
            raise
        except Exception as error:
            # Each storage has errors of its own.
            raise OSError(f"{self.url} does not answer: {error}") from error

    def has(self, name: str) -> bool:
        """Returns whether there is a file."""
        return bool(self._system.isfile(self._place(name)))

    def modification_time(self, name: str) -> float:
        """Returns when a file was written, in seconds since 1970.

        Raises:
            FileNotFoundError: There is none.
        """
        return _seconds(self._system.info(self._place(name)))

    def remove(self, name: str) -> int:
        """Removes a file; returns its size.

        Raises:
            FileNotFoundError: There is none.
        """
        place = self._place(name)
        size = int(self._system.info(place)["size"])
        self._system.rm_file(place)
        return size

    def names(self, folder: str) -> tuple[str, ...]:
        """Returns the names of what is in a folder; none if there is none.

        Raises:
            OSError: The storage does not answer.
        """
        with contextlib.suppress(FileNotFoundError), self._answers():
            found = self._system.ls(self._place(folder), detail=False, refresh=True)
            return tuple(sorted(one.rstrip("/").rpartition("/")[2] for one in found))
        return ()

    def files_below(self, folder: str) -> tuple[str, ...]:
        """Returns the names of all files below a folder, from it on; none if there is none."""
        root = f"{self._place(folder)}/"
        if is_of_objects(self._system.protocol):
            # By the beginning of their names that is one request; of a folder it would be three.
            parent, _, name = self._place(folder).rpartition("/")
            found: list[str] = self._system.find(parent, prefix=f"{name}/")
        else:
            try:
                found = self._system.find(self._place(folder), on_error="raise")
            except FileNotFoundError:
                return ()
        return tuple(name.removeprefix(root) for name in found if name.startswith(root))

    def remove_folder(self, folder: str) -> None:
        """Removes a folder and what is in it; nothing if there is none, or there are no folders."""
        if not is_of_objects(self._system.protocol):
            with contextlib.suppress(FileNotFoundError):
                self._system.rm(self._place(folder), recursive=True)

    def probe(self) -> None:
        """Writes a small file, and removes it.

        Raises:
            OSError: Nothing can be written.
        """
        place = self._place(f".probe.{os.getpid()}")
        try:
            self._system.pipe_file(place, b"can be written to")
            self._system.rm_file(place)
        except Exception as error:
            raise OSError(
                f"nothing can be written to {self.url}: {error}; check DRIVORA_TRACES_URL, and the "
                "rights and settings of its storage"
            ) from error

    def take(self, address: str, other: str) -> None:
        """Copies a file within the storage; nothing if there is none."""
        source, target = self._strip_url(address), self._strip_url(other)
        if not is_of_objects(self._system.protocol):
            self._system.makedirs(target.rpartition("/")[0], exist_ok=True)
        with contextlib.suppress(FileNotFoundError):
            self._system.cp_file(source, target)

    def _place(self, name: str) -> str:
        return f"{self._root}/{name}"

    def _strip_url(self, address: str) -> str:
        return self._place(address.removeprefix(f"{self.url}/"))


class RemoteTraceFolder:
    """The traces of runs in a storage; see ``RunTraces``."""

    def __init__(self, storage: Storage) -> None:
        self._storage = storage

    @property
    def place(self) -> str:
        """The address of the storage."""
        return self._storage.address("traces")

    def address(self, run_id: str, attempt: int = 1) -> str:
        """Returns the address of the trace of an attempt."""
        return self._storage.address(_name(run_id, attempt))

    def prepare(self, run_id: str, attempt: int = 1) -> str:
        """Returns the address: a file is replaced as a whole, and folders need not be made."""
        return self.address(run_id, attempt)

    def path(self, run_id: str, attempt: int = 1) -> Path:
        """Returns the path of a copy of the trace of an attempt, which may not exist."""
        copy = self._storage.copy_of(_name(run_id, attempt))
        # Earlier versions of Drivora, and backups, have one place for all attempts.
        return copy if attempt == 1 or copy.is_file() else self._storage.copy_of(_name(run_id))

    def modification_time(self, run_id: str) -> float:
        """Returns when the last trace of a run was written."""
        return max(map(self._storage.modification_time, self._files(run_id)))

    def remove(self, run_id: str) -> int:
        """Removes the traces of all attempts at a run; returns their size in bytes."""
        size = sum(map(self._storage.remove, self._files(run_id)))
        self._storage.remove_folder(_later_folder(run_id))
        return size

    def run_ids_by_folder(self) -> Iterator[tuple[str, ...]]:
        """Yields the ids of all runs that have a trace, one folder at a time."""
        for folder in self._storage.names("traces"):
            names = self._storage.names(f"traces/{folder}")
            files = {Path(name).stem for name in names if name.endswith(".parquet")}
            later = {name for name in names if "." not in name and self._later(name)}
            yield tuple(sorted(files | later))

    def _files(self, run_id: str) -> tuple[str, ...]:
        """Returns the names of the traces of all attempts; that of the first if there is none."""
        later, first = self._later(run_id), _name(run_id)
        return (*later, first) if not later or self._storage.has(first) else later

    def _later(self, run_id: str) -> tuple[str, ...]:
        """Returns the names of the traces of attempts after the first."""
        split = [name.partition("/") for name in self._storage.files_below(_later_folder(run_id))]
        folders = [folder for folder, _, file in split if file == f"{run_id}.parquet"]
        return tuple(_name(run_id, number) for number in later_attempts(folders))


class RemoteCampaignTraces:
    """The traces of failures of campaigns in a storage; see ``FailureTraces``."""

    def __init__(self, storage: Storage) -> None:
        self._storage = storage

    def address(self, campaign_id: str, name: str) -> str:
        """Returns the address of the trace ``name`` of a failure."""
        return self._storage.address(f"{_folder(campaign_id)}/{name}")

    def path(self, campaign_id: str, name: str) -> Path:
        """Returns the path of a copy of the trace of a failure, which may not exist."""
        return self._storage.copy_of(f"{_folder(campaign_id)}/{name}")

    def names(self, campaign_id: str) -> tuple[str, ...]:
        """Returns the names of the traces of a campaign."""
        return self._storage.names(_folder(campaign_id))

    def remove(self, campaign_id: str, name: str) -> int:
        """Removes a trace; returns its size in bytes."""
        return self._storage.remove(f"{_folder(campaign_id)}/{name}")

    def take(self, run: str, address: str) -> None:
        """Copies the trace of a run within the storage."""
        self._storage.take(run, address)


def _name(run_id: str, attempt: int = 1) -> str:
    later = _later_folder(run_id)
    return f"{later}.parquet" if attempt == 1 else f"{later}/{attempt}/{run_id}.parquet"


def _later_folder(run_id: str) -> str:
    return f"traces/{run_id[-2:]}/{run_id}"


def _folder(campaign_id: str) -> str:
    return f"campaigns/{campaign_id}/traces"


def _seconds(info: dict[str, Any]) -> float:
    for key in _MODIFIED:
        value = info.get(key)
        if isinstance(value, datetime):
            return value.timestamp()
        if isinstance(value, int | float):
            return float(value)
    # A file system that does not tell is taken to have written it just now: nothing is removed.
    return float("inf")
