"""What is wrong with a data folder or the file of a database, and what to do about it."""

from __future__ import annotations

import errno
import os
import pwd
from pathlib import Path

from drivora_service.errors import StoreError

CHOOSE = "choose another data folder with --data-dir or DRIVORA_DATA_DIR"
"""What helps with most faults of a data folder."""

_NO_ACCESS = (errno.EACCES, errno.EPERM)
_FULL = (errno.ENOSPC, errno.EDQUOT)


def make_folder_error(folder: Path, error: OSError) -> StoreError:
    """Returns the error of a data folder in which a file cannot be read, made or written.

    Args:
        folder: The data folder.
        error: What the operating system answered.
    """
    reason = error.strerror or str(error)
    if error.errno in _NO_ACCESS:
        owner = _other_owner(folder)
        reason += f"; it belongs to the user {owner!r}" if owner else ""
        return StoreError(f"the data folder {folder} cannot be used: {reason}; {CHOOSE}")
    if error.errno in _FULL:
        return StoreError(
            f"the data folder {folder} cannot be written: {reason}; free space there "
            f"(`drivora store prune` removes old runs), or {CHOOSE}"
        )
    return StoreError(f"the data folder {folder} cannot be written: {reason}; {CHOOSE}")


def advise_restore(file: Path) -> str:
    """Returns how to replace a damaged file of a database by that of a backup."""
    return (
        f"restore it: stop the service, move {file}, {file.name}-wal and {file.name}-shm away, "
        f"`cp BACKUP/drivora.sqlite3 {file}` (`drivora store backup BACKUP` makes a backup), "
        f"`drivora store verify`, and start the service again; or {CHOOSE}"
    )


def explain_sqlite_error(file: Path, name: str) -> str:
    """Returns what is wrong with the file of a database, and what to do; "" if that is unknown.

    Args:
        file: Path of the database.
        name: Symbolic name of SQLite's error code: ``SQLITE_FULL``.
    """
    if name.startswith("SQLITE_NOTADB"):
        return f"{file} is no SQLite database; {advise_restore(file)}"
    if name.startswith("SQLITE_CORRUPT"):
        return f"{file} is damaged; {advise_restore(file)}"
    if name == "SQLITE_FULL":
        return (
            f"the disk of {file} is full; free space there (`drivora store prune` removes old "
            f"runs), or {CHOOSE}"
        )
    if name.startswith(("SQLITE_CANTOPEN", "SQLITE_READONLY", "SQLITE_IOERR", "SQLITE_PERM")):
        return f"{_find_obstacle(file)}; {CHOOSE}"
    return ""


def _find_obstacle(file: Path) -> str:
    """Returns why a database cannot be opened and written."""
    if file.is_dir():
        return f"{file} is a folder, not a database"
    for path in (file.parent, file):
        if path.exists() and not os.access(path, os.W_OK):
            owner = _other_owner(path)
            whose = f"; it belongs to the user {owner!r}" if owner else ""
            return f"{path} cannot be written: {_access_reason(path)}{whose}"
    return f"{file} cannot be opened or written"


def _access_reason(path: Path) -> str:
    is_read_only = os.statvfs(path).f_flag & os.ST_RDONLY
    return os.strerror(errno.EROFS if is_read_only else errno.EACCES)


def _other_owner(path: Path) -> str:
    """Returns the name of the owner of a path, "" if that is the current user or unknown."""
    try:
        owner = path.stat().st_uid
    except OSError:
        return ""
    if owner == os.geteuid():
        return ""
    try:
        return pwd.getpwuid(owner).pw_name
    except KeyError:
        return str(owner)
