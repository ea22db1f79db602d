"""Catalogues of scenarios, networks, agents, testers and oracles; the state of the service."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from drivora_service.api_paths import PREFIX
from drivora_service.client.call import Call, get

if TYPE_CHECKING:
    from drivora_service.api.schemas.catalogues import (
        AgentList,
        ExampleScenarioList,
        MeasureList,
        ModelList,
        Network,
        NetworkList,
        OracleList,
        TesterList,
    )
    from drivora_service.api.schemas.network_geometry import NetworkGeometry
    from drivora_service.api.schemas.service import Health, Readiness
    from drivora_service.api.schemas.workers import Workers
    from drivora_service.networks.importing.source_formats import SourceFormat

_IMPORT_S = 180.0
"""Seconds for an import, which a service ends after two minutes."""


def example_scenarios() -> Call[ExampleScenarioList]:
    """Returns the example scenarios that come with the package."""
    from drivora_service.api.schemas.catalogues import ExampleScenarioList

    return get(f"{PREFIX}/scenarios:examples", ExampleScenarioList)


def networks() -> Call[NetworkList]:
    """Returns the road networks, shipped and imported."""
    from drivora_service.api.schemas.catalogues import NetworkList

    return get(f"{PREFIX}/networks", NetworkList)


def network(name: str) -> Call[Network]:
    """Describes a road network."""
    from drivora_service.api.schemas.catalogues import Network

    return get(f"{PREFIX}/networks/{{name}}", Network, name=name)


def import_network(
    file: Path,
    name: str,
    *,
    form: SourceFormat | None = None,
    replace: bool = False,
) -> Call[Network]:
    """Imports a road network from a file, and describes it; needs a token with the scope admin.

    Args:
        file: The file, which is sent as it is read.
        name: Name of the network.
        form: Format of the file; ``None``: by its name.
        replace: Replace an imported network of the same name.

    Raises:
        NetworkError: The name of the file tells no format.
    """
    from drivora_service.api.schemas.catalogues import Network
    from drivora_service.networks.importing.source_formats import format_of

    return Call(
        method="POST",
        template=f"{PREFIX}/networks",
        query={"name": name, "format": form or format_of(file.name), "replace": replace},
        body=file,
        headers={"Content-Type": "application/octet-stream"},
        answer=Network,
        # A second request would find the network of the first, if that was done.
        is_repeatable=replace,
        answer_s=_IMPORT_S,
    )


def network_geometry(name: str) -> Call[NetworkGeometry]:
    """Returns what is needed to draw a network: lanes, junctions, crossings, lights, signs."""
    from drivora_service.api.schemas.network_geometry import NetworkGeometry

    return get(f"{PREFIX}/networks/{{name}}/geometry", NetworkGeometry, name=name)


def agents() -> Call[AgentList]:
    """Returns the ADSs that can drive an ego."""
    from drivora_service.api.schemas.catalogues import AgentList

    return get(f"{PREFIX}/agents", AgentList)


def models() -> Call[ModelList]:
    """Returns the models of vehicles, walkers and obstacles that documents can name."""
    from drivora_service.api.schemas.catalogues import ModelList

    return get(f"{PREFIX}/models", ModelList)


def testers() -> Call[TesterList]:
    """Returns the testing methods that a campaign can name."""
    from drivora_service.api.schemas.catalogues import TesterList

    return get(f"{PREFIX}/testers", TesterList)


def oracles() -> Call[OracleList]:
    """Returns the oracles that every run is judged by."""
    from drivora_service.api.schemas.catalogues import OracleList

    return get(f"{PREFIX}/oracles", OracleList)


def describe_metrics() -> Call[MeasureList]:
    """Returns the descriptions of the metrics of runs and the objectives of searches."""
    from drivora_service.api.schemas.catalogues import MeasureList

    return get(f"{PREFIX}/metrics:describe", MeasureList)


def workers() -> Call[Workers]:
    """Returns what each worker does, how many runs wait and end, and what holds them up."""
    from drivora_service.api.schemas.workers import Workers

    return get(f"{PREFIX}/workers", Workers)


def health() -> Call[Health]:
    """Returns the version of the service; it answers as long as its process lives."""
    from drivora_service.api.schemas.service import Health

    return get("/healthz", Health)


def readiness() -> Call[Readiness]:
    """Returns whether runs can be taken and begun and campaigns started, or why not."""
    from drivora_service.api.schemas.service import Readiness

    return get("/readyz", Readiness, accepted=frozenset({503}))


def metrics() -> Call[str]:
    """Returns counts of runs, the queue, the workers and requests as text for Prometheus."""
    return get("/metrics", str)
