"""Where the machine code of kernels is kept; found without loading the compiler."""

from __future__ import annotations

import os
import sys
from pathlib import Path

_PACKAGE = Path(__file__).resolve().parents[1]
_FILES = "*.nbc"
_MAIN_FILES = "step_kernels*.nbc"
"""Those of the kernels of every step: without them, runs cannot begin before something compiles."""


def machine_code_folders() -> tuple[Path, ...]:
    """Returns the folders that kernels may be kept below, in the order in which they are tried.

    That is ``NUMBA_CACHE_DIR``, or else the package itself (in its ``__pycache__`` folders), and
    the user's cache where the package cannot be written.
    """
    given = os.environ.get("NUMBA_CACHE_DIR")
    if given:
        return (Path(given),)
    if sys.platform == "darwin":
        caches = Path.home() / "Library" / "Caches"
    else:
        caches = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return (_PACKAGE, caches / "numba")


def count_machine_code(folder: Path) -> int:
    """Returns the number of files of machine code in a folder and below it."""
    return sum(1 for _ in folder.rglob(_FILES))


def has_machine_code() -> bool:
    """Returns whether kernels were compiled before; after an upgrade they may be out of date."""
    return any(
        next(_searched(folder).rglob(_MAIN_FILES), None) is not None
        for folder in machine_code_folders()
    )


def _searched(folder: Path) -> Path:
    return _PACKAGE / "simulation" / "motion" / "__pycache__" if folder == _PACKAGE else folder
