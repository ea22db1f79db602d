"""Folders in which imported networks are prepared, and their publication in one step."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from drivora_service.errors import NetworkError, NetworkTaken

UPLOADING = ".uploading-"
"""Prefix of the folders of a service, of which one serves a folder of networks."""

_IMPORTING = ".importing-"


def make_stage(into: Path, prefix: str) -> Path:
    """Creates and returns a folder beside the networks, which no catalogue lists.

    Raises:
        OSError: It cannot be made.
    """
    into.mkdir(parents=True, exist_ok=True)
    # A network's name cannot begin with a dot.
    return Path(tempfile.mkdtemp(prefix=prefix, dir=into))


@contextmanager
def open_stage(into: Path) -> Iterator[Path]:
    """Provides a folder beside the networks, which is removed afterwards.

    Raises:
        NetworkError: A file cannot be written.
    """
    try:
        stage = make_stage(into, _IMPORTING)
    except OSError as error:
        raise NetworkError(f"cannot write to {into}: {error.strerror}") from error
    try:
        yield stage
    except OSError as error:
        raise NetworkError(f"cannot write the imported network: {error.strerror}") from error
    finally:
        shutil.rmtree(stage, ignore_errors=True)


def remove_left_uploads(into: Path) -> None:
    """Removes what uploads to a service that was killed have left behind."""
    for left in into.glob(f"{UPLOADING}*"):
        shutil.rmtree(left, ignore_errors=True)


def write_synced(path: Path, data: bytes) -> None:
    """Writes a file that is complete on the disk when this returns."""
    with path.open("wb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())


def publish(made: Path, target: Path, *, replace: bool) -> None:
    """Moves a prepared network into the catalogue.

    Of a network that is replaced, each file is replaced in one step, so that it can be found at any
    time.

    Args:
        made: Folder with the files of the network.
        target: Folder of the network.
        replace: Whether there may be one already.

    Raises:
        NetworkTaken: There is one, and it is not to be replaced.
        OSError: The files cannot be moved.
    """
    if replace and target.is_dir():
        # The network comes first: its provenance describes nothing without it.
        for file in sorted(made.iterdir(), key=lambda file: file.suffix != ".xml"):
            file.replace(target / file.name)
        _sync(target)
    else:
        try:
            made.rename(target)
        except OSError as error:
            if target.exists():
                raise make_taken_error(target.name) from error
            raise
    _sync(target.parent)


def make_taken_error(name: str) -> NetworkTaken:
    """Returns the error for a name that an imported network has."""
    return NetworkTaken(f"a network {name!r} is already imported; replace it or use another name")


def _sync(folder: Path) -> None:
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
