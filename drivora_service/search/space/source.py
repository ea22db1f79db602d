"""Gene spaces as text, for the workers that decode genes."""

from __future__ import annotations

from pydantic_core import from_json

from drivora_service.networks.catalogue import NetworkLookup
from drivora_service.runs.candidate import SpaceSource
from drivora_service.scenario.canonical import canonical_json, from_canonical
from drivora_service.search.candidate_space import CandidateSpace, OwnSpace
from drivora_service.search.space.own_space import make_space
from drivora_service.search.space.space_options import SpaceOptions
from drivora_service.shapes import adapter, to_json

_PLUGIN = "plugin"
"""Key of the options of a package's space, which those of the built-in one do not have."""


def source_of(space: CandidateSpace) -> SpaceSource:
    """Returns the text of a space."""
    kind = OwnSpace if isinstance(space.options, OwnSpace) else SpaceOptions
    return SpaceSource(
        seed=canonical_json(space.seed), options=to_json(kind, space.options).decode()
    )


def space_of(source: SpaceSource, networks: NetworkLookup) -> CandidateSpace:
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
    kind = OwnSpace if _PLUGIN in from_json(source.options) else SpaceOptions
    return make_space(seed, network, adapter(kind).validate_json(source.options))
