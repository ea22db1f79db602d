"""Gene spaces as text, for the workers that decode genes."""

from __future__ import annotations

from drivora_service.networks.catalogue import NetworkLookup
from drivora_service.runs.candidate import SpaceSource
from drivora_service.scenario.canonical import canonical_json, from_canonical
from drivora_service.search.space.scenario_space import ScenarioSpace
from drivora_service.search.space.space_options import SpaceOptions
from drivora_service.shapes import adapter, to_json


def source_of(space: ScenarioSpace) -> SpaceSource:
    """Returns the text of a space."""
    return SpaceSource(
        seed=canonical_json(space.seed), options=to_json(SpaceOptions, space.options).decode()
    )


def space_of(source: SpaceSource, networks: NetworkLookup) -> ScenarioSpace:
    """Builds the space of a text.

    Args:
        source: As :func:`source_of` returns it.
        networks: Catalogue for the town of the seed scenario.

    Raises:
        InvalidDocument: The seed scenario is not valid.
        SearchError: The space cannot be built.
        NetworkError: The network's file cannot be read.
        UnknownName: There is no such network.
    """
    seed = from_canonical(source.seed)
    network = networks.get(seed.map_region.town)
    return ScenarioSpace(seed, network, adapter(SpaceOptions).validate_json(source.options))
