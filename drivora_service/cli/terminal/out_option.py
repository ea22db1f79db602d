"""What ``--out`` names: checked before the work, written after it."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from drivora_service.cli.terminal.private_files import give_to_user
from drivora_service.errors import ConfigurationError


def check_folder(out: Path | None) -> None:
    """Creates a folder for results, if one is wanted.

    Raises:
        ConfigurationError: It cannot be made or written to.
    """
    if out is None:
        return
    with convert_write_errors(out):
        out.mkdir(parents=True, exist_ok=True)
    if not os.access(out, os.W_OK | os.X_OK):
        raise ConfigurationError(f"--out {out}: this folder cannot be written to; name another")


def check_file(out: Path | None) -> None:
    """Creates the folder of a file for a result, if one is wanted.

    Raises:
        ConfigurationError: The file cannot be written.
    """
    if out is None:
        return
    check_folder(out.parent)
    if out.is_dir():
        raise ConfigurationError(f"--out {out}: this is a folder; name a file")
    if out.exists() and not os.access(out, os.W_OK):
        raise ConfigurationError(f"--out {out}: this file cannot be written to; name another")


@contextmanager
def convert_write_errors(out: Path | None) -> Iterator[None]:
    """Names what cannot be written below a folder, or as a file.

    Raises:
        ConfigurationError: A file or a folder cannot be written.
    """
    try:
        yield
    except OSError as error:
        raise ConfigurationError(
            f"cannot write {error.filename or out}: {error.strerror or error}; name another place "
            "with --out"
        ) from error


def write_result(path: Path, text: str) -> None:
    """Writes a text for the user to a file, whose folder is made if it does not exist.

    Raises:
        ConfigurationError: It cannot be written.
    """
    with convert_write_errors(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        give_to_user(path)
