"""Obstacles from genes: near an ego's path, never on it."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from drivora_service.geometry.outlines import box_corners
from drivora_service.scenario.model import NpcObstacle
from drivora_service.scenario.models.actor_models import ActorKind, actor_model
from drivora_service.search.space.actor_starts import Start
from drivora_service.search.space.driven_path import Pose
from drivora_service.search.space.ego_genes import PlacedEgo
from drivora_service.search.space.obstacle_genes import CLEARANCE, MAX_LATERAL, blocks_lane
from drivora_service.search.space.space_options import SpaceOptions
from tests.search.space.seeds import SHIPPED, block_named, drawn, space_around

OPTIONS = SpaceOptions(vehicles=0, walkers=0, obstacles=2, weather=False)


def outline(obstacle: NpcObstacle) -> shapely.Polygon:
    model, place = actor_model(ActorKind.OBSTACLE, obstacle.model), obstacle.location
    x, y, yaw = (np.array([value]) for value in (place.x, place.y, place.yaw or 0.0))
    return shapely.Polygon(box_corners(x, y, yaw, model.length, model.width)[0])


@settings(max_examples=30)
@given(
    number=st.integers(0, 2**32 - 1),
    town=st.sampled_from(SHIPPED),
    egos=st.sampled_from([1, 3]),
)
def test_every_ego_has_room_in_the_middle_of_its_lane(number: int, town: str, egos: int) -> None:
    options = SpaceOptions(vehicles=0, walkers=0, obstacles=2, weather=False, egos=egos)
    space = space_around(town, options)
    values = drawn(space, number)
    scenario = space.scenario(values)
    width = actor_model(ActorKind.VEHICLE, scenario.ego_vehicles[0].model).width
    chosen = [
        space.routes[0 if egos == 1 else int(values[block_named(space, ego.id).index("path")])]
        for ego in scenario.ego_vehicles
    ]
    for obstacle in scenario.npc_obstacles:
        gaps = [
            shapely.distance(outline(obstacle), shapely.LineString(route.path.line))
            for route in chosen
        ]
        assert min(gaps) > 0.5 * width + 0.85 * CLEARANCE
        assert min(gaps) < MAX_LATERAL + 2.0


@given(
    s=st.floats(0.0, 150.0),
    lateral=st.floats(-6.0, 6.0),
    yaw=st.floats(-4.0, 4.0),
    size=st.tuples(st.floats(0.3, 8.0), st.floats(0.3, 3.0)),
)
def test_a_box_blocks_the_lane_if_it_is_too_near_to_a_point_of_the_way(
    s: float, lateral: float, yaw: float, size: tuple[float, float]
) -> None:
    space = space_around("roundabout", OPTIONS)
    vehicle, route = space.seed.ego_vehicles[0], space.routes[0]
    begin = Start(pose=route.path.at(0.0), length=4.5, width=2.0)
    ego = PlacedEgo(ego=vehicle, route=route, s=0.0, width=2.0, start=begin)
    place = ego.route.path.at(s).beside(lateral)
    start = Start(pose=Pose(x=place.x, y=place.y, yaw=yaw), length=size[0], width=size[1])
    x, y, turn = (np.array([value]) for value in (place.x, place.y, yaw))
    box = shapely.Polygon(box_corners(x, y, turn, *size)[0])
    gap = shapely.distance(box, shapely.MultiPoint(ego.route.path.line)) - 0.5 * ego.width
    assume(abs(gap - 0.9 * CLEARANCE) > 1e-6)
    assert blocks_lane(start, (ego,)) == (gap < 0.9 * CLEARANCE)


@pytest.mark.parametrize("lateral", [-4.0, -0.1, 0.1, 4.0])
def test_the_lateral_gene_says_on_which_side(lateral: float) -> None:
    space = space_around("rural", OPTIONS)
    values = drawn(space, 3)
    block = block_named(space, "obstacle_0")
    values[block.index("lateral")] = lateral
    place = space.scenario(values).npc_obstacles[0].location
    route = space.routes[0].path
    s, _ = route.place_of(place.x, place.y)
    pose = route.at(s)
    aside = -np.sin(pose.yaw) * (place.x - pose.x) + np.cos(pose.yaw) * (place.y - pose.y)
    assert np.sign(aside) == np.sign(lateral)
    if abs(lateral) == 4.0:
        assert abs(aside) == pytest.approx(4.0, abs=0.1)
