"""Replaceable parts by name: built-in ones, and plug-ins of installed packages.

A package provides one by an entry point; it is loaded on first use, so that a broken package
affects only its own plug-ins.
"""

from __future__ import annotations

import logging
import re
import sys
from collections.abc import Callable, Iterable, Mapping
from functools import lru_cache
from importlib.metadata import (
    EntryPoint,
    EntryPoints,
    PackageNotFoundError,
    distribution,
    entry_points,
)
from pathlib import Path
from typing import Generic, Protocol, TypeVar

from drivora_service.errors import DrivoraError, UnknownName
from drivora_service.foreign_errors import describe_exception
from drivora_service.visible_text import describe_acting_character

_log = logging.getLogger(__name__)

_PACKAGE = re.compile(r"of the package '([^']+)'")


class Plugin(Protocol):
    """An entry of a table."""

    @property
    def name(self) -> str:
        """Name in the table."""
        ...


P = TypeVar("P", bound=Plugin)


class PluginTable(Generic[P]):
    """Plug-ins of one kind by name. A package's never replaces a built-in one."""

    def __init__(
        self,
        *,
        kind: str,
        group: str,
        type_: type[P],
        built_in: Iterable[P],
        error: Callable[[str], DrivoraError],
    ) -> None:
        """Finds the plug-ins of installed packages, without loading them.

        Args:
            kind: Kind of the plug-ins, for messages: ``tester``.
            group: Group of their entry points.
            type_: Required type of an entry point's object.
            built_in: The built-in plug-ins.
            error: Makes the error for an entry point that cannot be used.
        """
        self._kind, self._group, self._type, self._error = kind, group, type_, error
        self._plugins: dict[str, P] = {plugin.name: plugin for plugin in built_in}
        self._found: dict[str, EntryPoint] = {
            point.name: point
            for point in _entry_points().get(group, ())
            if point.name not in self._plugins
        }
        self._versions: dict[str, dict[str, str]] = {}
        self._logged: set[EntryPoint] = set()

    def names(self) -> tuple[str, ...]:
        """Returns all names, sorted."""
        return tuple(sorted({*self._plugins, *self._found}))

    def is_of_package(self, name: str) -> bool:
        """Returns whether an installed package provides a plug-in."""
        return name in self._found

    def package(self, name: str) -> str:
        """Returns the name of a plug-in's package, "" for a built-in one."""
        point = self._found.get(name)
        return "" if point is None or point.dist is None else point.dist.name

    def versions(self, name: str) -> Mapping[str, str]:
        """Returns a plug-in's package with its version; nothing for a built-in one."""
        if name not in self._versions:
            # Cached: it reads a file, and agents are looked up for every candidate of a search.
            point = self._found.get(name)
            dist = None if point is None else point.dist
            self._versions[name] = {} if dist is None else {dist.name: dist.version}
        return self._versions[name]

    def plugin(self, name: str) -> P:
        """Returns a plug-in.

        Raises:
            UnknownName: There is none of that name.
            DrivoraError: A package's entry point cannot be loaded, or has another type.
        """
        if name not in self._plugins:
            if name not in self._found:
                raise UnknownName(self._kind, name, self.names())
            self._plugins[name] = self._load(self._found[name])
        return self._plugins[name]

    def _load(self, point: EntryPoint) -> P:
        package = "" if point.dist is None else point.dist.name
        where = f"entry point {point.name!r} of {self._group!r}"
        where += f" of the package {package!r}" if package else ""
        if fault := describe_acting_character(point.name):
            raise self._error(f"{where} cannot be used: its name has {fault}")
        try:
            loaded = point.load()
        except (Exception, SystemExit) as error:
            # An exception of a foreign package on import must not affect the other plug-ins.
            if point not in self._logged:
                self._logged.add(point)
                _log.info("%s cannot be loaded", where, exc_info=True)
            raise self._error(f"{where} cannot be loaded: {describe_exception(error)}") from error
        if not isinstance(loaded, self._type):
            raise self._error(
                f"{where} is a {type(loaded).__name__}; allowed: {self._type.__name__}"
            )
        if loaded.name != point.name:
            raise self._error(
                f"{where} is the {self._kind} {loaded.name!r}: give the entry point the same name"
            )
        return loaded


def describe_missing_packages(versions: Mapping[str, str], made: str) -> str:
    """Returns which packages are missing that took part in something, and how to install them.

    Args:
        versions: Versions of all software that took part, by the name of its package.
        made: What they took part in, as the beginning of a sentence: ``the run``.

    Returns:
        One sentence; "" if all are installed.
    """
    missing = {}
    for name, known in sorted(versions.items()):
        # Names with a slash are of files, not of packages.
        if "/" not in name and isinstance(known, str):
            try:
                distribution(name)
            except PackageNotFoundError:
                missing[name] = known
    if not missing:
        return ""
    named = ", ".join(f"{name} {known}" for name, known in missing.items())
    install = " ".join(f"{name}=={known}" for name, known in missing.items())
    return (
        f"{made} was made with {named}, not installed here: install it again (`python -m pip "
        f"install {install}`, or the folder of the package), and restart a service"
    )


def describe_plugin(kind: str, name: str, package: str) -> str:
    """Returns the words for a plug-in with which messages about it begin.

    Args:
        kind: Kind of the plug-in.
        name: Its name.
        package: Name of its package; "" for a built-in one.
    """
    return f"{kind} {name!r}" + (f" of the package {package!r}" if package else "")


def named_packages(message: str) -> tuple[str, ...]:
    """Returns the packages that a message about plug-ins names, each once."""
    return tuple(dict.fromkeys(_PACKAGE.findall(message)))


def _entry_points() -> Mapping[str, EntryPoints]:
    """Returns the entry points of all installed packages by group."""
    # Reading them takes longer than all else that a table does, and a campaign makes ten tables.
    return _entry_points_of(tuple((folder, _read_change_time(folder)) for folder in sys.path))


@lru_cache(maxsize=1)
def _entry_points_of(_folders: tuple[tuple[str, int], ...]) -> Mapping[str, EntryPoints]:
    found = entry_points()
    return {group: found.select(group=group) for group in found.groups}


def _read_change_time(folder: str) -> int:
    """Returns when a package was last installed in or removed from a folder, 0 if unknown."""
    try:
        return Path(folder).stat().st_mtime_ns
    except OSError:
        return 0
