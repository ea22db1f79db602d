"""The catalogues of a worker process, each made once."""

from __future__ import annotations

from functools import lru_cache

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.metrics.catalogue import MetricCatalogue
from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.oracles.catalogue import OracleCatalogue
from drivora_service.oracles.laws.sources import LawSource
from drivora_service.worker.setup import WorkerSetup


@lru_cache(maxsize=4)
def networks_of(setup: WorkerSetup) -> NetworkCatalogue:
    """Returns the catalogue of the process, so that each network is parsed once."""
    return NetworkCatalogue(setup.shipped_networks, setup.imported_networks)


@lru_cache(maxsize=1)
def agents_of(setup: WorkerSetup) -> AgentCatalogue:
    """Returns the catalogue of the process; ADSs that it starts are kept for later runs."""
    return AgentCatalogue(
        folder=setup.agents,
        longest_call_s=setup.agent_deadline_s,
        confinement=setup.confinement,
    )


def oracles_of(setup: WorkerSetup) -> OracleCatalogue:
    """Returns the catalogue of the process."""
    return _oracles(setup.laws, setup.installed_oracles)


@lru_cache(maxsize=1)
def _oracles(laws: tuple[LawSource, ...], _with_installed: bool) -> OracleCatalogue:
    # That of the fork server, which does without the oracles of packages, has those of another
    # time: they are found when a catalogue is made.
    return OracleCatalogue(laws)


def metrics_of(setup: WorkerSetup) -> MetricCatalogue:
    """Returns the catalogue of the process."""
    return _metrics(setup.installed_oracles)


@lru_cache(maxsize=1)
def _metrics(_with_installed: bool) -> MetricCatalogue:
    return MetricCatalogue()
