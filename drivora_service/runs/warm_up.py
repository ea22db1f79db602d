"""Getting a worker process ready before its first run.

The first run of a fresh installation would else compile the kernels within the first call of an
agent, which then looks as if it hung.
"""

from __future__ import annotations

from dataclasses import replace

from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.runs.performing import perform
from drivora_service.runs.report import RunSpec
from drivora_service.runs.worker_setup import WorkerSetup
from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.warm_up import warm_up_checks

_SIM_TIME_S = 1.0
_COMPILED = ("idm", "idm-mobil", "pdm-closed")
"""Agents with kernels of their own."""


def warm_up(setup: WorkerSetup) -> None:
    """Performs runs of a second of simulation on a shipped network and forgets them."""
    scenario = warm_up_checks(NetworkCatalogue(setup.shipped_networks))
    short = replace(scenario, max_sim_time=_SIM_TIME_S)
    for agent in _COMPILED:
        perform(RunSpec(run_id="warm-up", document=canonical_json(short), agent=agent), setup)
