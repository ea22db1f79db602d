"""No actor that a candidate adds enters the area that an ego could use, in the real simulation."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from shapely import STRtree
from shapely.affinity import rotate, translate
from shapely.geometry import box

from drivora_service.networks.catalogue import shipped_networks
from drivora_service.observations.reference_path import recorded_path
from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import Trace
from drivora_service.runs.candidate import CandidateSource, Reference
from drivora_service.scenario.canonical import from_canonical
from drivora_service.scenario.model import NpcBehavior, Scenario
from drivora_service.search.space.scenario_space import ScenarioSpace
from drivora_service.search.space.source import source_of
from drivora_service.search.space.space_options import SpaceOptions
from drivora_service.worker.candidate_preparing import prepare
from drivora_service.worker.setup import WorkerSetup
from tests.search.space.seeds import space_around
from tests.simulation.episodes import run

Floats = NDArray[np.float64]

SETUP = WorkerSetup(shipped_networks=shipped_networks())
SLACK = 1.0
"""Seconds."""


def options(behavior: NpcBehavior) -> SpaceOptions:
    return SpaceOptions(
        vehicles=3, walkers=2, obstacles=2, optional=True, weather=False, behavior=behavior
    )


@lru_cache(maxsize=8)
def reference_of(town: str, behavior: NpcBehavior) -> tuple[ScenarioSpace, Floats]:
    """A space, and the path of its ego without other actors."""
    space = space_around(town, options(behavior))
    view = RunView(run(space.seed), space.network)
    return space, recorded_path(view.egos[0])


def candidate(space: ScenarioSpace, path: Floats, number: int, *, kept: bool) -> Scenario:
    """A scenario of drawn genes with all actors present; with or without keeping clear."""
    values = space.genes.sample(np.random.default_rng(number))
    for block in space.genes.optional_blocks:
        values[block.start] = 1.0
    paths = tuple(map(tuple, path.tolist()))
    source = CandidateSource(
        space=source_of(space),
        values=tuple(values.tolist()),
        reference=Reference(paths=(paths,)) if kept else None,
    )
    made = prepare(source, SETUP)
    assert not made.problem
    assert prepare(source, SETUP).document == made.document, "the same genes, the same scenario"
    scenario = from_canonical(made.document)
    poses = len(scenario.ego_vehicles[0].reference_path)
    assert poses == (len(path) if kept else 0)
    return scenario


def outline(x: float, y: float, yaw: float, low: float, high: float, half: float) -> Any:
    shape = box(low, -half, high, half)
    return translate(rotate(shape, yaw, origin=(0, 0), use_radians=True), x, y)


def entries(trace: Trace, path: Floats) -> set[str]:
    """Returns the actors that are ever within the area, by shapely, on a coarser grid of time.

    The area is a little smaller than documented, as the grids differ.
    """
    ego = trace.actors[0]
    moments = np.arange(0.0, path[-1, 0], 0.2)
    yaw = np.interp(moments, path[:, 0], np.unwrap(path[:, 3]))
    areas = [
        outline(x, y, a, -0.5 * ego.length, 0.5 * ego.length + 4.9, 0.5 * ego.width + 0.45)
        for x, y, a in zip(
            np.interp(moments, path[:, 0], path[:, 1]),
            np.interp(moments, path[:, 0], path[:, 2]),
            yaw,
            strict=True,
        )
    ]
    tree = STRtree(areas)
    found = set()
    for row in range(0, trace.step_count, 2):
        near = np.flatnonzero(np.abs(moments - trace.times[row]) <= SLACK - 0.1)
        for actor in trace.actors[1:]:
            if actor.id in found or not trace.present[row, actor.row]:
                continue
            x, y, a = trace.states[row, actor.row, :3]
            shape = outline(x, y, a, -0.5 * actor.length, 0.5 * actor.length, 0.5 * actor.width)
            hit = tree.query(shape, predicate="intersects")
            if np.isin(hit, near).any():
                found.add(actor.id)
    return found


@pytest.mark.slow
@pytest.mark.parametrize("town", ["tee-town", "arterial"])
@pytest.mark.parametrize("behavior", [NpcBehavior.REPLAY, NpcBehavior.REACTIVE])
def test_no_added_actor_enters_the_area_in_the_real_simulation(
    town: str, behavior: NpcBehavior
) -> None:
    space, path = reference_of(town, behavior)
    added, entered = 0, set()
    for number in range(5):
        scenario = candidate(space, path, number, kept=True)
        trace = run(scenario)
        assert entries(trace, path) == set()
        added += len(trace.actors) - 1
    # The check finds those that are not kept out.
    for number in range(8):
        free = candidate(space, path, number, kept=False)
        entered |= {(number, name) for name in entries(run(free), path)}
        if len(entered) > 2:
            break
    assert added > 16, "candidates still have actors"
    assert len(entered) > 2


def test_actors_that_always_are_there_are_left_alone() -> None:
    seed = space_around("tee-town", options(NpcBehavior.REPLAY))
    fixed = ScenarioSpace(
        seed.seed, seed.network, replace(options(NpcBehavior.REPLAY), optional=False)
    )
    _, path = reference_of("tee-town", NpcBehavior.REPLAY)
    for number in range(3):
        kept = candidate(fixed, path, number, kept=True)
        free = candidate(fixed, path, number, kept=False)
        assert kept.npc_vehicles == free.npc_vehicles
        assert kept.npc_walkers == free.npc_walkers
