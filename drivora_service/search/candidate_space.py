"""What a space of candidates must offer, and the plug-ins that bring one of their own."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Generic, Protocol, TypeAlias, TypeVar

from drivora_service.geometry.array_shapes import BoolArray, FloatArray
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.scenario.model import Scenario
from drivora_service.search.genes import Block, GeneSpace
from drivora_service.search.space.space_options import SpaceOptions
from drivora_service.search.space.vehicles.vehicle_ways import VehicleWay

P = TypeVar("P")


@dataclass(frozen=True, slots=True, kw_only=True)
class OwnSpace:
    """The choice of a space of an installed package.

    Attributes:
        plugin: Its name.
        parameters: Parameters that differ from their defaults.
    """

    plugin: str
    parameters: Mapping[str, Any] = field(default_factory=dict)


SpaceChoice: TypeAlias = SpaceOptions | OwnSpace
"""The variable parts around a seed scenario: of the built-in space, or of a package's."""


class DecodedSpace(Protocol):
    """What a plug-in makes: genes, and how they become a scenario.

    The same seed scenario, network and parameters give the same space, and the same values the same
    scenario, in every process: workers decode the genes again.
    """

    @property
    def genes(self) -> GeneSpace:
        """All genes with their bounds."""
        ...

    def repair(self, values: FloatArray) -> FloatArray:
        """Returns (d,) values within the bounds that are better to use, or the same ones.

        Repairing them again changes nothing.

        Args:
            values: (d,) genes within the bounds; not changed.
        """
        ...

    def scenario(self, values: FloatArray) -> Scenario:
        """Returns the scenario that repaired values (d,) encode; it is checked afterwards."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class SpacePlugin(Generic[P]):
    """The object of an entry point of the group ``drivora_service.spaces``.

    Attributes:
        name: Name in campaign files; letters, digits, dashes.
        description: One sentence: what varies.
        parameters: A frozen dataclass with a default for every field; a campaign's parameters are
            checked against its types.
        create: Makes the space of a seed scenario on its road network. Raises ``SearchError`` if
            it cannot.
    """

    name: str
    description: str
    parameters: type[P]
    create: Callable[[Scenario, RoadNetwork, P], DecodedSpace]


class CandidateSpace(Protocol):
    """A space as campaigns and workers use it; see :class:`ScenarioSpace`."""

    @property
    def seed(self) -> Scenario:
        """The seed scenario."""
        ...

    @property
    def network(self) -> RoadNetwork:
        """Its road network."""
        ...

    @property
    def options(self) -> SpaceChoice:
        """What chose the space."""
        ...

    @property
    def genes(self) -> GeneSpace:
        """All genes with their bounds."""
        ...

    @property
    def conflicts(self) -> BoolArray | None:
        """(n, n) which routes of egos meet; ``None``: not known."""
        ...

    @property
    def ego_distance(self) -> Callable[[Block, FloatArray], float | None] | None:
        """Returns how far from an ego's start an actor appears; ``None``: not known."""
        ...

    def repair(self, values: FloatArray) -> FloatArray:
        """Returns (d,) values within the bounds; repairing them again changes nothing."""
        ...

    def scenario(self, values: FloatArray) -> Scenario:
        """Returns the scenario that repaired values (d,) encode."""
        ...

    def decode_alike(self, one: FloatArray, other: FloatArray) -> bool:
        """Returns whether two candidates (d,) cannot be told apart by their runs."""
        ...

    def vehicle_ways(self, values: FloatArray) -> Sequence[VehicleWay]:
        """Returns the ways of NPC vehicles whose genes may be without effect, as far as known."""
        ...
