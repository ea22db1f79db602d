"""Preparing a worker process before its first run.

Otherwise the first run of a fresh installation would compile the kernels during the first call of
an agent, which would look like a hang.
"""

from __future__ import annotations

import math
import os
from dataclasses import replace

from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.runs.run_report import RunSpec
from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.check_warm_up import warm_up_checks
from drivora_service.scenario.model import (
    BackgroundTraffic,
    FrictionPatch,
    NpcObstacle,
    Scenario,
)
from drivora_service.worker.performing import perform
from drivora_service.worker.setup import WorkerSetup
from drivora_service.worker.worker_catalogues import metrics_of, oracles_of

_SIM_TIME_S = 1.0
_COMPILED = ("idm", "idm-mobil", "pdm-closed")
"""Agents with kernels of their own."""

_TRAFFIC_AFTER_S = 0.2
"""Before the ego hits the obstacle."""
_AHEAD_M = 8.0
_SPEED = 15.0
_OBSTACLE = "static.prop.container"

_warmed: set[int] = set()
"""Ids of the processes that have performed all runs of :func:`warm_up`.

A worker inherits that of its fork server, with its compiled kernels.
"""


def warm_up(setup: WorkerSetup) -> None:
    """Performs runs of one simulated second on a shipped network and discards them.

    A process whose fork server has performed them repeats one of them if oracles judge or metrics
    measure that the fork server does not have, and else none.
    """
    inherits = bool(_warmed - {os.getpid()})
    if inherits and not oracles_of(setup).has_others and not metrics_of(setup).installed_names:
        return
    scenario = warm_up_checks(NetworkCatalogue(setup.shipped_networks))
    short = replace(scenario, max_sim_time=_SIM_TIME_S)
    if not inherits:
        for agent in _COMPILED:
            perform(RunSpec(run_id="warm-up", document=canonical_json(short), agent=agent), setup)
    # SUMO is started only where it drives a vehicle, and catches up when that enters later.
    traffic = BackgroundTraffic(count=1, start_time=_TRAFFIC_AFTER_S)
    short = replace(short, background_traffic=traffic)
    crash = canonical_json(_into_an_obstacle(short))
    perform(RunSpec(run_id="warm-up", document=crash, agent=_COMPILED[0]), setup)
    _warmed.add(os.getpid())


def _into_an_obstacle(scenario: Scenario) -> Scenario:
    """Returns the scenario with an obstacle that its first ego must hit.

    Judging a collision uses kernels of its own, and so do slippery patches: there is one.
    """
    ego, *others = scenario.ego_vehicles
    start = ego.route[0]
    yaw = 0.0 if start.yaw is None else start.yaw
    ahead = replace(
        start, x=start.x + _AHEAD_M * math.cos(yaw), y=start.y + _AHEAD_M * math.sin(yaw)
    )
    obstacle = NpcObstacle(id="obstacle", model=_OBSTACLE, location=ahead)
    return replace(
        scenario,
        ego_vehicles=(replace(ego, initial_speed=_SPEED), *others),
        npc_obstacles=(*scenario.npc_obstacles, obstacle),
        friction_patches=(
            FrictionPatch(
                id="patch", location=start, length=_AHEAD_M, width=_AHEAD_M, friction=0.9
            ),
        ),
    )
