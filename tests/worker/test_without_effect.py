"""Genes without an effect: changing them gives every ego the same run, step by step."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.networks.catalogue import shipped_networks
from drivora_service.runs.candidate import CandidateSource
from drivora_service.runs.run_report import RunReport, RunSpec, RunStatus
from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.model import (
    BackgroundTraffic,
    NpcBehavior,
    NpcVehicle,
    RouteEnd,
    WeatherChange,
)
from drivora_service.search.mutation import redraw_genes
from drivora_service.search.space.scenario_space import ScenarioSpace
from drivora_service.search.space.source import source_of
from drivora_service.search.space.space_options import SpaceOptions, VehicleStarts
from drivora_service.worker.performing import perform
from drivora_service.worker.setup import WorkerSetup
from tests.search.space.seeds import NETWORKS, block_named, drawn, space_around

SETUP = WorkerSetup(shipped_networks=shipped_networks())
FOG = SpaceOptions(vehicles=6, walkers=1, optional=True, reach=200.0, weather=False)


def foggy(town: str, options: SpaceOptions = FOG, number: int = 0) -> ScenarioSpace:
    """A space in dense fog, so that much is out of reach."""
    space = space_around(town, options, number)
    weather = replace(space.seed.weather, fog_density=95.0)
    return ScenarioSpace(replace(space.seed, weather=weather), NETWORKS.get(town), options)


def run(space: ScenarioSpace, values: FloatArray) -> RunReport:
    source = CandidateSource(space=source_of(space), values=tuple(values.tolist()))
    spec = RunSpec(run_id="run", document=canonical_json(space.scenario(values)), candidate=source)
    report = perform(spec, SETUP)
    assert report.status is RunStatus.FINISHED
    return report


def changed(space: ScenarioSpace, values: FloatArray, which: list[int], seed: int) -> FloatArray:
    """Redraws some genes; nothing is repaired, as none of them moves a start."""
    flags = np.zeros(len(values), dtype=np.bool_)
    flags[which] = True
    mutant = redraw_genes(values, space.genes, np.random.default_rng(seed), flags)
    np.testing.assert_array_equal(space.repair(mutant), mutant)
    return mutant


@pytest.mark.parametrize("town", ["tee-town", "signal-grid"])
def test_no_change_of_these_genes_changes_an_ego(town: str) -> None:
    space = foggy(town)
    tried = 0
    for number in range(4):
        values = drawn(space, number)
        report = run(space, values)
        genes = list(report.without_effect)
        if genes:
            mutant = run(space, changed(space, values, genes, seed=number))
            assert mutant.egos_sha256 == report.egos_sha256
            tried += 1
    assert tried >= 3


@pytest.mark.slow
@pytest.mark.parametrize("behavior", [NpcBehavior.REACTIVE, NpcBehavior.REPLAY])
@pytest.mark.parametrize("town", ["tee-town", "signal-grid", "old-town", "roundabout"])
def test_no_change_of_these_genes_changes_an_ego_in_many_runs(
    town: str, behavior: NpcBehavior
) -> None:
    space = foggy(town, replace(FOG, behavior=behavior), number=1)
    random = np.random.default_rng(5)
    out_of_reach = 0
    for number in range(16):
        values = drawn(space, 100 + number)
        report = run(space, values)
        genes = np.array(report.without_effect, dtype=np.int64)
        absent = set(genes_of_absent_actors(space, values))
        out_of_reach += len(set(genes.tolist()) - absent)
        for trial in range(1):
            some = random.permutation(genes)[: random.integers(1, len(genes) + 1)]
            mutant = run(space, changed(space, values, some.tolist(), seed=trial))
            assert mutant.egos_sha256 == report.egos_sha256
    assert out_of_reach > 8


@pytest.mark.slow
@pytest.mark.parametrize("town", ["tee-town", "old-town"])
@pytest.mark.parametrize(
    "more",
    [
        {"at_end": RouteEnd.STAY},
        {"max_deceleration": 9.0, "max_lateral_acceleration": 6.0},
        {"max_wait": 6.0, "at_end": RouteEnd.STAY, "behavior": NpcBehavior.REPLAY},
        {"slice_time": 3.0, "max_deceleration": 9.0, "min_speed": 0.0},
        {"patches": 3},
        {"patches": 2, "max_wait": 6.0, "max_deceleration": 3.0, "starts": VehicleStarts.FIXED},
    ],
    ids=["stays", "brakes", "waits", "slices", "patches", "all"],
)
def test_no_change_of_these_genes_changes_an_ego_however_vehicles_drive(
    town: str, more: dict[str, Any]
) -> None:
    space = foggy(town, replace(FOG, **more), number=1)
    random = np.random.default_rng(6)
    compared = 0
    for number in range(4):
        values = drawn(space, 200 + number)
        report = run(space, values)
        genes = np.array(report.without_effect, dtype=np.int64)
        for trial in range(2 if len(genes) else 0):
            some = random.permutation(genes)[: random.integers(1, len(genes) + 1)]
            mutant = run(space, changed(space, values, some.tolist(), seed=trial))
            assert mutant.egos_sha256 == report.egos_sha256
            compared += 1
    assert compared > 6


def test_nothing_but_absence_counts_where_a_run_changes() -> None:
    space = foggy("tee-town", number=1)
    (ego,) = space.seed.ego_vehicles
    route = tuple(replace(place, speed=None) for place in ego.route)
    late = NpcVehicle(
        id="late", model="vehicle.lincoln.mkz_2017", route=route, start_time=30.0, joins=True
    )
    clear = WeatherChange(time=3.0, weather=replace(space.seed.weather, fog_density=0.0))
    out_of_reach = 0
    for number in range(4):
        values = drawn(space, 100 + number)
        absent = genes_of_absent_actors(space, values)
        out_of_reach += len(run(space, values).without_effect) - len(absent)
        for seed in (
            replace(space.seed, npc_vehicles=(*space.seed.npc_vehicles, late)),
            replace(space.seed, weather_changes=(clear,)),
        ):
            changes = ScenarioSpace(seed, space.network, FOG)
            values = drawn(changes, 100 + number)
            absent = genes_of_absent_actors(changes, values)
            assert list(run(changes, values).without_effect) == absent
    assert out_of_reach > 2


def genes_of_absent_actors(space: ScenarioSpace, values: FloatArray) -> list[int]:
    return [
        index
        for block in space.genes.optional_blocks
        if values[block.start] == 0.0
        for index in range(block.start + 1, block.stop)
    ]


def test_all_genes_of_an_absent_actor_but_its_presence_are_without_effect() -> None:
    space = space_around("tee-town", SpaceOptions(vehicles=2, walkers=1, optional=True))
    values = drawn(space, 1)
    for name in ("vehicle_1", "walker_0"):
        values[block_named(space, name).start] = 0.0
    found = set(run(space, values).without_effect)
    for name in ("vehicle_1", "walker_0"):
        block = block_named(space, name)
        assert set(range(block.start + 1, block.stop)) <= found
        assert block.start not in found


def test_a_vehicle_beside_the_ego_has_no_genes_without_effect_before_the_end() -> None:
    """In clear weather an ego perceives all of a small town."""
    space = space_around("tee-town", SpaceOptions(vehicles=3, walkers=0, weather=False))
    for number in range(3):
        found = run(space, drawn(space, number)).without_effect
        names = {space.genes.genes[gene].name for gene in found}
        # The speeds of waypoints that a slow vehicle does not come to.
        assert names <= {"speed_2", "speed_3", "speed_4"}


def test_nothing_but_absence_counts_where_sumo_drives() -> None:
    for behavior, traffic in ((NpcBehavior.SUMO, None), (NpcBehavior.REACTIVE, 3)):
        space = foggy("signal-grid", replace(FOG, behavior=behavior))
        seed = space.seed
        if traffic is not None:
            seed = replace(seed, background_traffic=BackgroundTraffic(count=traffic))
        space = ScenarioSpace(seed, space.network, replace(FOG, behavior=behavior))
        for number in range(2):
            values = drawn(space, number)
            assert list(run(space, values).without_effect) == genes_of_absent_actors(space, values)


def test_nothing_but_absence_counts_for_an_ego_that_perceives_without_limits() -> None:
    space = foggy("signal-grid")
    values = drawn(space, 0)
    own = run(space, values)
    source = CandidateSource(space=source_of(space), values=tuple(values.tolist()))
    document = canonical_json(space.scenario(values))
    spec = RunSpec(run_id="run", document=document, candidate=source, agent="sumo-krauss")
    report = perform(spec, SETUP)
    assert list(report.without_effect) == genes_of_absent_actors(space, values)
    assert len(own.without_effect) > len(report.without_effect)


def test_a_run_of_a_document_tells_no_genes() -> None:
    space = space_around("tee-town")
    document = canonical_json(space.scenario(drawn(space, 1)))
    report = perform(RunSpec(run_id="run", document=document), SETUP)
    assert report.without_effect == ()
    assert report.egos_sha256
