"""Replaceable parts by name: those built in, and those that installed packages bring.

A package brings one by an entry point; it is loaded when somebody asks for it, so that a broken
package takes only its own part away.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from importlib.metadata import EntryPoint, entry_points
from typing import Generic, Protocol, TypeVar

from drivora_service.errors import DrivoraError, UnknownName


class Plugin(Protocol):
    """What a table holds."""

    @property
    def name(self) -> str:
        """Name in the table."""
        ...


P = TypeVar("P", bound=Plugin)


class PluginTable(Generic[P]):
    """Plug-ins of one kind by name. A built-in one is never replaced by a package's."""

    def __init__(
        self,
        *,
        kind: str,
        group: str,
        type_: type[P],
        built_in: Iterable[P],
        error: Callable[[str], DrivoraError],
    ) -> None:
        """Looks up which packages bring plug-ins, without loading them.

        Args:
            kind: What the plug-ins are, for messages: ``tester``.
            group: Of their entry points.
            type_: What an entry point must give.
            built_in: Those that are always there.
            error: Makes the error for an entry point that cannot be used.
        """
        self._kind, self._group, self._type, self._error = kind, group, type_, error
        self._plugins: dict[str, P] = {plugin.name: plugin for plugin in built_in}
        self._found: dict[str, EntryPoint] = {
            point.name: point
            for point in entry_points(group=group)
            if point.name not in self._plugins
        }
        self._versions: dict[str, dict[str, str]] = {}

    def names(self) -> tuple[str, ...]:
        """Returns all names, sorted."""
        return tuple(sorted({*self._plugins, *self._found}))

    def package(self, name: str) -> str:
        """Returns the name of the package that brings a plug-in, "" if none does."""
        point = self._found.get(name)
        return "" if point is None or point.dist is None else point.dist.name

    def versions(self, name: str) -> Mapping[str, str]:
        """Returns the package that brings a plug-in, with its version; nothing if none does."""
        if name not in self._versions:
            # Reads a file, while agents are looked up for every candidate of a search.
            point = self._found.get(name)
            dist = None if point is None else point.dist
            self._versions[name] = {} if dist is None else {dist.name: dist.version}
        return self._versions[name]

    def plugin(self, name: str) -> P:
        """Returns a plug-in.

        Raises:
            UnknownName: If there is none of that name.
            DrivoraError: If a package's entry point cannot be loaded, or gives something else.
        """
        if name not in self._plugins:
            if name not in self._found:
                raise UnknownName(self._kind, name, self.names())
            self._plugins[name] = self._load(self._found[name])
        return self._plugins[name]

    def _load(self, point: EntryPoint) -> P:
        where = f"entry point {point.name!r} of {self._group!r}"
        try:
            loaded = point.load()
        except (Exception, SystemExit) as error:
            # Whatever a foreign package does on import must not take the other plug-ins away.
            raise self._error(
                f"{where} cannot be loaded: {type(error).__name__}: {error}"
            ) from error
        if not isinstance(loaded, self._type):
            raise self._error(
                f"{where} gives a {type(loaded).__name__}; allowed: {self._type.__name__}"
            )
        if loaded.name != point.name:
            raise self._error(
                f"{where} gives the {self._kind} {loaded.name!r}: call the entry point like it"
            )
        return loaded
