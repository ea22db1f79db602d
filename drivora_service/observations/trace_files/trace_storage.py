"""Writing a trace to its address: a path, or a file of a storage that ``fsspec`` knows."""

from __future__ import annotations

import contextlib
import tempfile
import uuid
from pathlib import Path

from drivora_service.errors import StoreError
from drivora_service.observations.trace import Trace
from drivora_service.observations.trace_files.trace_file import write_trace


def store_trace(trace: Trace, address: str) -> None:
    """Writes a trace; readers see all of it or nothing.

    Args:
        trace: The trace.
        address: A path, or an address such as ``s3://bucket/folder/file.parquet``.

    Raises:
        StoreError: It cannot be written, or ``meta`` is not JSON-able.
    """
    if "://" not in address:
        write_trace(trace, Path(address))
        return
    import fsspec

    name = address.rpartition("/")[2]
    with tempfile.TemporaryDirectory(prefix="drivora-trace-") as folder:
        file = Path(folder) / name
        write_trace(trace, file)
        try:
            system, place = fsspec.core.url_to_fs(address)
            # Of a storage of objects, one is replaced as a whole; in a file system, by its name.
            part = f"{place}.{uuid.uuid4().hex}.part"
            if is_of_objects(system.protocol):
                system.put_file(str(file), place)
            else:
                system.makedirs(place.rpartition("/")[0], exist_ok=True)
                system.put_file(str(file), part)
                system.mv(part, place)
        except Exception as error:
            # Each storage has errors of its own.
            raise StoreError(f"cannot write the trace {address}: {error!r}") from error


def remove_stored(address: str) -> None:
    """Removes a trace, if there is one."""
    if "://" not in address:
        Path(address).unlink(missing_ok=True)
        return
    import fsspec

    system, place = fsspec.core.url_to_fs(address)
    with contextlib.suppress(FileNotFoundError):
        system.rm_file(place)


def is_of_objects(protocol: str | tuple[str, ...]) -> bool:
    """Returns whether a storage has objects, which appear as a whole and need no folder.

    Args:
        protocol: Its protocol, or all its names.
    """
    names = (protocol,) if isinstance(protocol, str) else protocol
    return not _OF_OBJECTS.isdisjoint(names)


_OF_OBJECTS = frozenset({"s3", "s3a", "gs", "gcs", "abfs", "abfss", "az", "oss"})
"""Protocols of storages of objects; moving one means copying it."""
