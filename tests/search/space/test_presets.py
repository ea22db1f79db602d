"""The named spaces: complete, as published, and drivable on every network."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from drivora_service.errors import SearchError
from drivora_service.scenario.model import RouteEnd
from drivora_service.scenario.validation import scenario_problems
from drivora_service.search.genes import Part
from drivora_service.search.space.presets import PRESETS, SpacePreset
from drivora_service.search.space.scenario_space import ScenarioSpace
from drivora_service.search.space.space_options import SpaceOptions
from drivora_service.search.space.vehicles.fixed_starts import DISTANCES
from tests.search.space.seeds import NETWORKS, SHIPPED, drawn, seed_scenario, space_around
from tests.search.space.test_runs import reports


def preset_around(town: str, name: SpacePreset) -> ScenarioSpace:
    return space_around(town, PRESETS[name].options)


def test_every_name_has_a_space() -> None:
    assert set(PRESETS) == set(SpacePreset)
    assert PRESETS[SpacePreset.DEFAULT].options == SpaceOptions()
    assert all(preset.description for preset in PRESETS.values())


@pytest.mark.parametrize("name", SpacePreset)
@pytest.mark.parametrize("town", SHIPPED)
def test_drawn_candidates_are_valid(town: str, name: SpacePreset) -> None:
    space = preset_around(town, name)
    for number in range(12):
        values = drawn(space, number)
        assert space.genes.within(values)
        assert not scenario_problems(space.scenario(values), NETWORKS, ["idm"])


@pytest.mark.parametrize("town", SHIPPED)
def test_avfuzzers_space_has_twenty_genes(town: str) -> None:
    space = preset_around(town, SpacePreset.AVFUZZER)
    assert len(space.genes) == 20
    assert space.genes.varies.all()
    assert [block.part for block in space.genes.blocks] == [Part.VEHICLE, Part.VEHICLE]
    for block in space.genes.blocks:
        names = [gene.name for gene in block.genes]
        assert names == [f"{name}_{k}" for name in ("speed", "manoeuvre") for k in range(5)]


@pytest.mark.parametrize("town", SHIPPED)
def test_avfuzzers_starts_are_fixed_and_near_the_ego(town: str) -> None:
    space = preset_around(town, SpacePreset.AVFUZZER)
    ego = space.seed.ego_vehicles[0].route[0]
    starts = set()
    for number in range(10):
        vehicles = space.scenario(drawn(space, number)).npc_vehicles
        assert len(vehicles) == 2
        assert {npc.at_end for npc in vehicles} == {RouteEnd.STAY}
        starts.add(tuple((npc.model, npc.route[0].x, npc.route[0].y) for npc in vehicles))
    ((first, second),) = starts
    assert first[1:] != second[1:]
    for _, x, y in (first, second):
        assert 10.0 < np.hypot(x - ego.x, y - ego.y) < 1.5 * max(DISTANCES)


def test_avfuzzers_vehicles_start_in_two_lanes_where_there_are_two() -> None:
    space = preset_around("arterial", SpacePreset.AVFUZZER)
    route = space.routes[0].path
    vehicles = space.scenario(drawn(space, 0)).npc_vehicles
    ahead, beside = (route.place_of(npc.route[0].x, npc.route[0].y) for npc in vehicles)
    assert ahead[0] == pytest.approx(DISTANCES[0], abs=3.0)
    assert ahead[1] < 0.6
    assert beside[0] == pytest.approx(DISTANCES[1], abs=3.0)
    assert beside[1] == pytest.approx(3.5, abs=0.3)


def test_behavexplors_vehicles_stop_at_their_ends_and_keep_their_lanes() -> None:
    space = preset_around("signal-grid", SpacePreset.BEHAVEXPLOR)
    speeds = []
    for number in range(10):
        scenario = space.scenario(drawn(space, number))
        assert (len(scenario.npc_vehicles), scenario.npc_walkers) == (5, ())
        assert scenario.weather == space.seed.weather
        for npc in scenario.npc_vehicles:
            assert npc.at_end is RouteEnd.STAY
            speeds += [place.speed for place in npc.route if place.speed is not None]
    assert 0.2 <= min(speeds) < 2.0
    assert max(speeds) <= max(lane.speed_limit for lane in space.network.lanes)


def test_doppeltests_scenarios_have_two_to_five_egos_and_up_to_five_walkers() -> None:
    space = preset_around("tee-town", SpacePreset.DOPPELTEST)
    egos, walkers, times = set(), set(), []
    for number in range(60):
        scenario = space.scenario(drawn(space, number))
        egos.add(len(scenario.ego_vehicles))
        walkers.add(len(scenario.npc_walkers))
        times += [walker.start_time for walker in scenario.npc_walkers]
        assert scenario.npc_vehicles == space.seed.npc_vehicles
    assert egos == {2, 3, 4, 5}
    assert walkers >= {1, 2, 3, 4}
    assert 15.0 < max(times) <= 30.0


def test_no_place_for_so_many_fixed_starts() -> None:
    options = replace(PRESETS[SpacePreset.AVFUZZER].options, vehicles=64, paths=1)
    with pytest.raises(SearchError, match="of 64 NPC vehicles with fixed starts, only"):
        ScenarioSpace(seed_scenario("rural"), NETWORKS.get("rural"), options)


@pytest.mark.slow
@pytest.mark.parametrize("name", [SpacePreset.AVFUZZER, SpacePreset.BEHAVEXPLOR])
def test_candidates_run_to_their_end(name: SpacePreset) -> None:
    for town in ("highway", "signal-grid"):
        found = reports(preset_around(town, name), 6)
        assert {report.status.value for report in found} == {"finished"}
        assert len({report.trace_sha256 for report in found}) == 6
