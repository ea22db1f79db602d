"""A space of an installed package, as campaigns and workers use it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np

from drivora_service.errors import SearchError, UnknownName
from drivora_service.geometry.array_shapes import BoolArray, FloatArray
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.parameters import read_parameters
from drivora_service.plugin_table import PluginTable
from drivora_service.scenario.model import Scenario
from drivora_service.search.candidate_space import (
    CandidateSpace,
    OwnSpace,
    SpaceChoice,
    SpacePlugin,
)
from drivora_service.search.genes import Block, GeneSpace
from drivora_service.search.space.scenario_space import ScenarioSpace
from drivora_service.search.space.space_options import SpaceOptions
from drivora_service.search.space.vehicles.vehicle_ways import VehicleWay

T = TypeVar("T")


class PluginSpace:
    """Calls a space of a package, and attributes its mistakes to it.

    Attributes:
        seed: The seed scenario.
        network: Its road network.
        options: What chose the space.
        genes: All genes with their bounds.
        conflicts: Not known.
        ego_distance: Not known.
    """

    conflicts: BoolArray | None = None
    ego_distance: Callable[[Block, FloatArray], float | None] | None = None

    def __init__(
        self, seed: Scenario, network: RoadNetwork, options: OwnSpace, plugin: SpacePlugin[Any]
    ) -> None:
        """Makes the space of a seed scenario.

        Raises:
            SearchError: The plug-in has no such parameters, or cannot make the space.
        """
        self.seed, self.network, self.options = seed, network, options
        self._name = f"space {plugin.name!r}"
        parameters = read_parameters(plugin.parameters, options.parameters, of=self._name)
        self._own = self._call("made", lambda: plugin.create(seed, network, parameters))
        genes = self._call("asked for its genes", lambda: self._own.genes)
        if not isinstance(genes, GeneSpace):
            raise SearchError(
                f"{self._name} has genes of the type {type(genes).__name__}; a GeneSpace is needed"
            )
        self.genes = genes

    def repair(self, values: FloatArray) -> FloatArray:
        """Clips values (d,) to the bounds and lets the package repair them.

        Raises:
            SearchError: The package raised, or returned no values within the bounds.
        """
        clipped = self.genes.clip(values)
        repaired = np.asarray(
            self._call("asked to repair values", lambda: self._own.repair(clipped.copy())),
            dtype=np.float64,
        )
        if not self.genes.within(repaired):
            raise SearchError(
                f"{self._name} repaired values to others that are not within the bounds of its "
                f"{len(self.genes)} genes"
            )
        return repaired

    def scenario(self, values: FloatArray) -> Scenario:
        """Returns the scenario that repaired values (d,) encode.

        Raises:
            SearchError: The package raised, or returned something else.
        """
        made = self._call("asked to decode values", lambda: self._own.scenario(values.copy()))
        if not isinstance(made, Scenario):
            raise SearchError(
                f"{self._name} decoded values to a {type(made).__name__}; a Scenario is needed"
            )
        return made

    def decode_alike(self, one: FloatArray, other: FloatArray) -> bool:
        """Returns whether two candidates (d,) decode to equal scenarios."""
        return self.scenario(one) == self.scenario(self.repair(other))

    def vehicle_ways(self, _values: FloatArray) -> tuple[VehicleWay, ...]:
        """Returns nothing: which genes move which vehicle is not known."""
        return ()

    def _call(self, what: str, work: Callable[[], T]) -> T:
        try:
            return work()
        except SearchError:
            raise
        except (Exception, SystemExit) as error:
            raise SearchError(
                f"{self._name} raised {type(error).__name__} when it was {what}: {error}"
            ) from error


def space_plugins() -> PluginTable[SpacePlugin[Any]]:
    """Returns the spaces of installed packages by name; the built-in space is none of them."""
    return PluginTable(
        kind="space",
        group="drivora_service.spaces",
        type_=SpacePlugin,
        built_in=(),
        error=SearchError,
    )


def make_space(seed: Scenario, network: RoadNetwork, options: SpaceChoice) -> CandidateSpace:
    """Makes the space of candidates around a seed scenario.

    Raises:
        SearchError: It cannot be made: options contradict one another or the seed, or its package
            is not installed here.
        NetworkError: The network's file cannot be read.
    """
    if isinstance(options, SpaceOptions):
        return ScenarioSpace(seed, network, options)
    try:
        plugin = space_plugins().plugin(options.plugin)
    except UnknownName as error:
        raise SearchError(
            f"the space {options.plugin!r} is of a package that is not installed here; install it "
            "again, and restart a service"
        ) from error
    return PluginSpace(seed, network, options, plugin)
