"""Files that only their owner may read, and files of the user beside them."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path

_PRIVATE = 0o077

_user_umask: ContextVar[int | None] = ContextVar("user_umask", default=None)
"""The umask that this process was started with, while its files are private."""


def keep_files_private() -> None:
    """Makes every file that this process and its children create from now on private.

    Files get mode 0600 and folders 0700: what a data folder holds, scenarios, results, logs and
    hashes of tokens, is of no concern to the other users of a machine. Called before the first
    child is started.
    """
    os.umask(_PRIVATE)


@contextmanager
def private_files() -> Iterator[None]:
    """Makes files private while it is open, also for children that are started meanwhile."""
    before = os.umask(_PRIVATE)
    token = _user_umask.set(before)
    try:
        yield
    finally:
        _user_umask.reset(token)
        os.umask(before)


def give_to_user(path: Path) -> None:
    """Sets the mode of a file or folder written for the user to what the user's umask allows.

    The umask itself is one for all threads, and others may be writing to the data folder.
    """
    umask = _user_umask.get()
    if umask is not None:
        path.chmod((0o777 if path.is_dir() else 0o666) & ~umask)
