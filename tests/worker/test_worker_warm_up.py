"""A process that has been warmed up compiles nothing within the first call of an agent."""

from __future__ import annotations

import multiprocessing
import os
from concurrent.futures import ProcessPoolExecutor
from typing import Any
from unittest import mock

import pytest

from drivora_service.agents.idm import driving
from drivora_service.agents.idm_mobil import incentive
from drivora_service.agents.pdm_closed import proposals, scoring
from drivora_service.execution.fork_server import prepare_processes
from drivora_service.networks.catalogue import shipped_networks
from drivora_service.oracles.avoidability import braking_evasion, evasion, risk
from drivora_service.oracles.laws.sources import LawSource
from drivora_service.simulation.motion import step_kernels
from drivora_service.simulation.sumo import is_started
from drivora_service.worker import worker_warm_up
from drivora_service.worker.setup import WorkerSetup
from drivora_service.worker.worker_warm_up import warm_up
from tests.oracles.laws.laws import source_of


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


OWN_LAWS = (source_of("speed < 2"),)


def runs_of_warm_up(laws: tuple[LawSource, ...]) -> int:
    """Returns how many runs a worker performs in its warm-up."""
    with mock.patch.object(worker_warm_up, "perform") as perform:
        warm_up(WorkerSetup(shipped_networks=shipped_networks(), laws=laws))
    return perform.call_count


@pytest.mark.parametrize(("laws", "runs"), [((), 0), (OWN_LAWS, 1)])
def test_a_worker_repeats_only_what_its_fork_server_cannot_have_done(
    laws: tuple[LawSource, ...], runs: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(worker_warm_up, "_warmed", {os.getppid()})
    assert runs_of_warm_up(laws) == runs
    # A process without such a parent, and the fork server itself, perform all of them.
    monkeypatch.setattr(worker_warm_up, "_warmed", set())
    assert runs_of_warm_up(laws) == 4
    assert worker_warm_up._warmed == {os.getpid()}
    assert runs_of_warm_up(laws) == 4


@pytest.mark.slow
def test_workers_inherit_the_warm_up_of_their_fork_server() -> None:
    # A process of its own: its fork server is the one that workers have.
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as process:
        assert process.submit(_runs_of_a_worker).result() == 0


def _runs_of_a_worker() -> int:
    prepare_processes()
    with multiprocessing.get_context("forkserver").Pool(1) as workers:
        runs: int = workers.apply(runs_of_warm_up, ((),))
    return runs
