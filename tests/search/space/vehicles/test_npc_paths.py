"""The paths that NPC vehicles choose from."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely

from drivora_service.errors import SearchError
from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.scenario.model import MapRegion, Region
from drivora_service.search.space.relations import Relation
from drivora_service.search.space.scenario_space import ScenarioSpace
from drivora_service.search.space.space_options import SpaceOptions
from drivora_service.search.space.vehicles.npc_paths import find_npc_paths
from tests.search.space.seeds import NETWORKS, SHIPPED, seed_scenario, space_around


@pytest.mark.parametrize("town", SHIPPED)
def test_starts_are_on_roads_near_the_route(town: str) -> None:
    space = space_around(town)
    network = space.network
    route = shapely.LineString(space.routes[0].path.line)
    for path in space.paths:
        assert route.distance(shapely.Point(path.path.line[0])) <= SpaceOptions().reach + 2.0
        for share in np.linspace(0.0, 1.0, 11):
            s = path.start_at(float(share))
            lane = network.lanes[path.path.lane_ranges[path.path.range_at(s)][0]]
            assert lane.drivable
            assert not lane.is_internal
        assert path.start_at(0.0) == pytest.approx(path.starts[0][0])
        assert path.start_at(1.0) == pytest.approx(path.starts[-1][1])


@pytest.mark.parametrize("town", SHIPPED)
def test_paths_differ_and_neighbours_have_other_relations(town: str) -> None:
    paths = space_around(town).paths
    assert len({path.path.line.tobytes() for path in paths}) == len(paths)
    relations = [path.relation for path in paths]
    first_round = len(set(relations))
    assert len(set(relations[:first_round])) == first_round
    assert Counter(relations)[Relation.TRAILING] <= 4


def test_ways_of_every_relation_are_there_where_the_roads_offer_them() -> None:
    relations = {path.relation for path in space_around("signal-grid", number=0).paths}
    assert relations == set(Relation)


def test_no_more_are_taken_than_wanted() -> None:
    assert len(space_around("tee-town", SpaceOptions(paths=7)).paths) == 7


def test_a_way_is_long_enough_for_the_time_of_the_ego() -> None:
    space = space_around("tee-town")
    wanted = min(space.routes[0].path.length, 200.0)
    for path in space.paths:
        assert path.path.length - path.start_at(1.0) >= wanted - 1.0


def test_real_towns_have_ways(shared_data: Path) -> None:
    towns = NetworkCatalogue(shared_data / "maps")
    for town in ("Town01", "Town04"):
        assert len(space_around(town, number=0, networks=towns).paths) >= 9


def test_no_way_leaves_the_region_of_the_seed() -> None:
    seed = seed_scenario("tee-town")
    line = space_around("tee-town").routes[0].path.line
    low, high = line.min(axis=0) - 90.0, line.max(axis=0) + 90.0
    region = Region(min_x=low[0], max_x=high[0], min_y=low[1], max_y=high[1])
    inside = replace(seed, map_region=MapRegion(town="tee-town", region_segment=region))
    space = ScenarioSpace(inside, NETWORKS.get("tee-town"), SpaceOptions())
    assert 0 < len(space.paths) < len(space_around("tee-town").paths)
    for path in space.paths:
        assert (path.path.line >= low).all()
        assert (path.path.line <= high).all()


def test_a_missing_path_is_an_error() -> None:
    route = space_around("tee-town").routes[0].path
    nowhere = Region(min_x=-1.0, max_x=1.0, min_y=-1.0, max_y=1.0)
    with pytest.raises(SearchError, match=r"within 80 m of the egos' routes .*raise `reach`"):
        find_npc_paths(NETWORKS.get("tee-town"), [route], reach=80.0, count=5, region=nowhere)
