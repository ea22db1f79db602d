"""A process that has been warmed up compiles nothing within the first call of an agent."""

from __future__ import annotations

from typing import Any

import pytest

from drivora_service.agents.idm import driving
from drivora_service.agents.idm_mobil import incentive
from drivora_service.agents.pdm_closed import proposals, scoring
from drivora_service.networks.catalogue import shipped_networks
from drivora_service.oracles.avoidability import braking_evasion, evasion, risk
from drivora_service.simulation.motion import step_kernels
from drivora_service.simulation.sumo import is_started
from drivora_service.worker.setup import WorkerSetup
from drivora_service.worker.worker_warm_up import warm_up


@pytest.mark.slow
def test_the_kernels_of_agents_and_oracles_are_compiled() -> None:
    warm_up(WorkerSetup(shipped_networks=shipped_networks()))
    kernels: tuple[Any, ...] = (
        driving.decide,
        incentive.find_neighbours,
        proposals.propose,
        scoring.score,
        braking_evasion._brakes_clear,
        evasion._evade,
        risk._beside,
        risk._flag_hidden,
        risk._will_meet,
        step_kernels.write_placements,
    )
    assert all(kernel.dispatcher.signatures for kernel in kernels)
    assert is_started()
