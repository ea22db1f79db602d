"""The catalogue of testers, and of components that can replace their parts."""

from __future__ import annotations

import contextlib
from collections.abc import Iterable, Mapping
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from drivora_service.errors import SearchError
from drivora_service.parameters import read_parameters
from drivora_service.plugin_table import PluginTable
from drivora_service.search.components import Components
from drivora_service.search.mutation import GAUSSIAN, REDRAW_BLOCK, REDRAW_GENE, REDRAW_SLICE
from drivora_service.search.plugin import MutationPlugin, SelectionPlugin, TesterPlugin
from drivora_service.search.selection import RANDOM_SELECTION, ROULETTE, TOURNAMENT, TRUNCATION
from drivora_service.search.tester import Tester, TesterContext
from drivora_service.search.testers.avfuzzer.search import AVFUZZER
from drivora_service.search.testers.behavexplor.tester import BEHAVEXPLOR
from drivora_service.search.testers.decictor.search import DECICTOR
from drivora_service.search.testers.deepcollision.tester import DEEPCOLLISION
from drivora_service.search.testers.doppeltest.tester import DOPPELTEST
from drivora_service.search.testers.drivefuzz.tester import DRIVEFUZZ
from drivora_service.search.testers.lawbreaker.search import LAWBREAKER
from drivora_service.search.testers.random_search import RANDOM
from drivora_service.search.testers.samota.tester import SAMOTA

BUILT_IN: tuple[TesterPlugin[Any], ...] = (
    RANDOM,
    AVFUZZER,
    BEHAVEXPLOR,
    SAMOTA,
    DOPPELTEST,
    LAWBREAKER,
    DRIVEFUZZ,
    DEEPCOLLISION,
    DECICTOR,
)
BUILT_IN_MUTATIONS = (GAUSSIAN, REDRAW_BLOCK, REDRAW_GENE, REDRAW_SLICE)
BUILT_IN_SELECTIONS = (RANDOM_SELECTION, ROULETTE, TOURNAMENT, TRUNCATION)


def installed_versions(packages: Iterable[str]) -> dict[str, str]:
    """Returns the versions of those packages that are installed."""
    found = {}
    for package in packages:
        with contextlib.suppress(PackageNotFoundError):
            found[package] = version(package)
    return found


class TesterCatalogue:
    """Testers by name."""

    def __init__(self, built_in: tuple[TesterPlugin[Any], ...] = BUILT_IN) -> None:
        self._table = PluginTable(
            kind="tester",
            group="drivora_service.testers",
            type_=TesterPlugin,
            built_in=built_in,
            error=SearchError,
        )

    def names(self) -> tuple[str, ...]:
        """Returns the names of all testers, sorted."""
        return self._table.names()

    def plugin(self, name: str) -> TesterPlugin[Any]:
        """Returns a tester's plug-in.

        Raises:
            UnknownName: There is no tester of that name.
            SearchError: The entry point of an installed package is no tester.
        """
        return self._table.plugin(name)

    def package(self, name: str) -> str:
        """Returns the name of a tester's package, "" for a built-in one."""
        return self._table.package(name)

    def versions(self, name: str) -> Mapping[str, str]:
        """Returns the packages of a tester with their versions, as far as they are installed.

        That of its plug-in is none for a built-in tester.
        """
        needed = self.plugin(name).packages
        return {**self._table.versions(name), **installed_versions(needed)}

    def create(
        self,
        name: str,
        context: TesterContext,
        parameters: Mapping[str, Any],
        components: Components,
    ) -> Tester:
        """Returns a new tester.

        Args:
            name: Name of the tester.
            context: Context of the tester.
            parameters: Parameters that the campaign sets; the others keep their defaults.
            components: Components that replace the tester's own.

        Raises:
            UnknownName: There is no tester of that name.
            SearchError: It has no such parameter, or not with that value, or cannot search the
                space.
        """
        plugin = self.plugin(name)
        read = read_parameters(plugin.parameters, parameters, of=f"tester {name!r}")
        return plugin.create(context, read, components)


def mutation_plugins() -> PluginTable[MutationPlugin]:
    """Returns the mutations by name."""
    return PluginTable(
        kind="mutation",
        group="drivora_service.mutations",
        type_=MutationPlugin,
        built_in=BUILT_IN_MUTATIONS,
        error=SearchError,
    )


def selection_plugins() -> PluginTable[SelectionPlugin]:
    """Returns the selections by name."""
    return PluginTable(
        kind="selection",
        group="drivora_service.selections",
        type_=SelectionPlugin,
        built_in=BUILT_IN_SELECTIONS,
        error=SearchError,
    )


def make_components(*, mutation: str = "", selection: str = "") -> Components:
    """Returns the components that a campaign names; "" keeps the tester's own.

    Raises:
        UnknownName: There is no component of that name.
        SearchError: The entry point of an installed package is no component.
    """
    return Components(
        mutation=mutation_plugins().plugin(mutation).create() if mutation else None,
        selection=selection_plugins().plugin(selection).create() if selection else None,
    )
