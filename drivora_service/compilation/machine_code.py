"""The machine code of kernels on disk.

A kernel is compiled together with the kernels and constants of other modules that it uses. Its
cached machine code must not outlive a change of those, by an upgrade or by an edit: the compiler's
own cache checks the file of the kernel alone.
"""

from __future__ import annotations

import hashlib
import os
import sys
from collections.abc import Callable
from enum import Enum
from functools import lru_cache
from pathlib import Path
from types import FunctionType
from typing import Any

from numba import config, njit
from numba.core import event
from numba.core.caching import (
    InTreeCacheLocator,
    UserProvidedCacheLocator,
    UserWideCacheLocator,
)

from drivora_service.compilation.compilation_progress import VARIABLE, note_kernel
from drivora_service.compilation.kernel import Kernel

_MARK = "drivora_kernel"
"""Attribute of functions that are compiled here, not by other packages."""

_CONSTANTS = (bool, int, float, str, tuple)


def dispatcher_of(function: Callable[..., Any]) -> Any:
    """Returns what compiles a function, and finds its machine code by the types of arguments."""
    setattr(function, _MARK, True)
    return njit(cache=True, error_model="numpy")(function)


def hash_dependencies(function: FunctionType) -> str:
    """Returns a digest of what a kernel may use: the files of kernels, and the values of constants.

    Its own module and those that it imports must have been imported.
    """
    digest = hashlib.sha256()
    for part in sorted(_parts(function.__globals__, frozenset({function.__module__}))):
        digest.update(part.encode())
    return digest.hexdigest()


def _parts(names: dict[str, Any], known: frozenset[str]) -> set[str]:
    parts = {_file_digest(str(names["__file__"]))}
    for name, value in names.items():
        if isinstance(value, Kernel):
            module = str(value.function.__module__)
            if module not in known:
                parts |= _parts(vars(sys.modules[module]), known | {module})
        elif isinstance(value, type) and issubclass(value, Enum):
            parts.add(f"{name}: {[(member.name, member.value) for member in value]}")
        elif isinstance(value, type) and issubclass(value, tuple):
            # Machine code takes the fields of a record by their places.
            parts.add(f"{name}: {getattr(value, '_fields', ())}")
        elif isinstance(value, _CONSTANTS) and not name.startswith("__"):
            parts.add(f"{name}: {value!r}")
    return parts


@lru_cache(maxsize=256)
def _file_digest(path: str) -> str:
    return hashlib.sha256(Path(path).read_bytes()).hexdigest()


class _UsedStamp:
    """Makes the cache of a kernel depend on all that it was compiled from."""

    _used: str = ""

    @classmethod
    def from_function(cls, function: Any, path: str) -> Any:
        """Returns the locator of a function; ``None`` if it cannot be cached here."""
        found = super().from_function(function, path)  # type: ignore[misc] # of the other base
        if found is not None and hasattr(function, _MARK):
            found._used = hash_dependencies(function)
        return found

    def get_source_stamp(self) -> object:
        """Returns the stamp that must be equal for a cached function to be used."""
        stamp: object = super().get_source_stamp()  # type: ignore[misc] # of the other base
        return stamp, self._used


class GivenFolder(_UsedStamp, UserProvidedCacheLocator):
    """Keeps machine code in ``NUMBA_CACHE_DIR``."""


class BesideSource(_UsedStamp, InTreeCacheLocator):
    """Keeps machine code beside the module."""


class UsersFolder(_UsedStamp, UserWideCacheLocator):
    """Keeps machine code in the user's cache, if the module's folder cannot be written."""


class _Compilations(event.Listener):
    """Notes each kernel that was compiled; one that was read from disk raises no event."""

    def on_start(self, event: Any) -> None:
        """Does nothing."""

    def on_end(self, event: Any) -> None:
        """Notes the kernel."""
        if hasattr(event.data["dispatcher"].py_func, _MARK):
            note_kernel()


if VARIABLE in os.environ:
    event.register("numba:compile", _Compilations())  # type: ignore[no-untyped-call] # numba is untyped

# Before the first compilation: results do not depend on the features of a machine's processor, and
# all processes share the machine code on disk.
vars(config).update(
    CPU_NAME="generic",
    CPU_FEATURES="",
    CACHE_LOCATOR_CLASSES=", ".join(
        f"{__name__}.{locator.__name__}" for locator in (GivenFolder, BesideSource, UsersFolder)
    ),
)
