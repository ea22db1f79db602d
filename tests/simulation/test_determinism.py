"""The same plan gives the same trace, bit for bit, wherever and whenever it runs."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

from drivora_service.observations.trace_files.trace_hash import trace_sha256
from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.model import (
    BackgroundTraffic,
    LightTimes,
    NpcVehicle,
    Scenario,
    TrafficLights,
    Weather,
)
from tests.simulation.episodes import (
    car,
    ego,
    obstacle,
    place,
    run,
    scenario,
    track,
    walker,
)

IN_A_NEW_PROCESS = """
import sys
from drivora_service.observations.trace_files.trace_hash import trace_sha256
from drivora_service.scenario.canonical import from_canonical
from tests.simulation.episodes import run
print(trace_sha256(run(from_canonical(sys.stdin.read()))))
"""


def everything(seed: int = 3) -> Scenario:
    """Every kind of entity at once."""
    on = "signal-grid"
    return scenario(
        ego(place("grand_1_1", 20, on=on), place("grand_3_2", 80, on=on), name="one"),
        ego(place("castle_1_1", 20, on=on), place("queen_3_1", 60, on=on), name="two"),
        on=on,
        npc_vehicles=(
            car(place("grand_1_1", 60, on=on), place("grand_2_1", 60, on=on), name="reactive"),
            car(
                place("-bridge_2_1", 20, on=on), place("-bridge_1_1", 60, on=on), name="driven",
                behavior="sumo", start_time=1.0,
            ),
        ),
        npc_walkers=(
            walker(place("grand_1_1", 90, on=on, right=6), place("grand_1_1", 90, on=on, right=-2)),
        ),
        npc_obstacles=(obstacle(place("queen_2_1", 50, on=on, right=3.0)),),
        weather=Weather(fog_density=60.0, precipitation=40.0, wind_intensity=30.0),
        traffic_lights=TrafficLights(times=LightTimes(green=8.0)),
        background_traffic=BackgroundTraffic(count=20),
        seed=seed,
        seconds=15.0,
    )  # fmt: skip


def test_twice_in_a_process_and_in_a_new_one(repository: Path) -> None:
    what = everything()
    first = trace_sha256(run(what))
    run(scenario(ego(place("harbour_1_0", 20), place("harbour_1_0", 100)), seconds=3.0))
    assert trace_sha256(run(what)) == first
    fresh = subprocess.run(
        [sys.executable, "-c", IN_A_NEW_PROCESS],
        input=canonical_json(what), capture_output=True, text=True, check=True, cwd=repository,
    )  # fmt: skip
    assert fresh.stdout.strip() == first


def test_an_unfinished_episode_leaves_nothing_behind() -> None:
    what = everything()
    first = trace_sha256(run(what))
    run(replace(what, max_sim_time=4.0))
    assert trace_sha256(run(what)) == first


def test_another_seed_gives_another_run() -> None:
    first, other = run(everything(3)), run(everything(4))
    assert trace_sha256(first) != trace_sha256(other)
    rows = [a.row for a in first.actors if a.id.startswith("background")]
    assert not np.array_equal(first.states[1, rows, :2], other.states[1, rows, :2], equal_nan=True)


def test_an_actor_far_away_does_not_move_the_egos() -> None:
    what = replace(everything(), weather=Weather())
    far: NpcVehicle = car(place("corner_northeast_1", 20, on="signal-grid", right=60.0), name="far")
    alone, watched = run(what), run(replace(what, npc_vehicles=(*what.npc_vehicles, far)))
    for actor in ("one", "two", "reactive", "driven", "walker", "background:0", "background:7"):
        a, b = track(alone, actor), track(watched, actor)
        assert np.array_equal(a, b, equal_nan=True), actor
