"""What rasters show of a network, against polygons that other code makes."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely
from shapely.geometry.base import BaseGeometry

from drivora_service.agents.interface import AgentContext, Observation
from drivora_service.agents.raster.birds_eye import BirdsEyeRaster
from drivora_service.agents.raster.polygon_filling import LINE_WIDTH
from drivora_service.agents.raster.raster_map import raster_map
from drivora_service.agents.raster.raster_settings import Channel, RasterSettings
from drivora_service.geometry.lines import offset_line
from drivora_service.networks.drivable_area import drivable_area
from drivora_service.networks.heights import line_heights
from drivora_service.networks.line_controls import LineControl, line_controls
from drivora_service.networks.markings import Marking, lane_markings
from drivora_service.networks.network_loading import load_network
from drivora_service.networks.road_network import Lane, RoadNetwork
from drivora_service.networks.stop_lines import stop_lines
from drivora_service.observations.trace import LEVEL_GAP
from tests.agents.raster.scenes import (
    assert_shows,
    contains,
    context_on,
    on_route,
    pixel_places,
    polygons_of,
    seen_from,
)
from tests.simulation.episodes import network

TOWNS = ("tee-town", "signal-grid", "roundabout")
POSES = 4
MOVED = 0.012
"""Metres by which the simplification of lines may move a border, with some rounding."""


def poses(context: AgentContext, seed: int) -> Iterator[Observation]:
    """Yields observations at random places near the route, in any direction."""
    random = np.random.default_rng(seed)
    heights = line_heights(context.network, context.route.line, context.route.point_lanes)
    for s in random.uniform(0.0, context.route.length, POSES).tolist():
        x, y, _ = on_route(context.route, s)
        beside = random.uniform(-3.0, 3.0, 2)
        z = float(np.interp(s, context.route.arc, heights))
        yield seen_from(x + beside[0], y + beside[1], random.uniform(-4.0, 4.0), z=z, route_s=s)


def lane_areas(lanes: list[Lane]) -> list[BaseGeometry]:
    return [
        shapely.LineString(lane.shape).buffer(0.5 * lane.width, cap_style="flat", quad_segs=4)
        for lane in lanes
    ]


def lanes_around(town: RoadNetwork, observation: Observation | None) -> list[Lane]:
    """Returns the drivable lanes that may be in an image, or all."""
    lanes = [lane for lane in town.lanes if lane.drivable]
    if observation is None:
        return lanes
    place = observation.ego[:2]
    gaps = [
        np.maximum(lane.shape.min(axis=0) - place, place - lane.shape.max(axis=0)) for lane in lanes
    ]
    return [lane for lane, gap in zip(lanes, gaps, strict=True) if gap.max() < 100.0]


def area_at(town: RoadNetwork, z: float, observation: Observation | None = None) -> BaseGeometry:
    """Returns the drivable area on the level of a height, from whole lanes and junctions."""
    lanes = lanes_around(town, observation)
    ends: dict[str, list[float]] = {}
    for lane in lanes:
        ends.setdefault(lane.to_junction, []).append(float(lane.heights[-1]))
    level = [lane for lane in lanes if is_level(lane.heights.min(), lane.heights.max(), z)]
    junctions = [
        shapely.make_valid(shapely.Polygon(town.junction_shapes[junction]))
        for junction, heights in ends.items()
        if junction in town.junction_shapes and is_level(min(heights), max(heights), z)
    ]
    return polygons_of(lane_areas(level) + junctions)


def is_level(low: float, high: float, z: float) -> bool:
    return low - z <= LEVEL_GAP and z - high <= LEVEL_GAP


@pytest.mark.parametrize("town", TOWNS)
def test_a_pixel_is_drivable_if_its_centre_is_on_a_lane_or_in_a_junction(town: str) -> None:
    context = context_on(network(town))
    settings = RasterSettings(channels=(Channel.DRIVABLE,))
    raster = context.raster(settings)
    area = area_at(network(town), 0.0)
    judged = drivable_area(network(town))
    same = both = 0
    for observation in poses(context, 3):
        image = raster.draw(observation)[0]
        places = pixel_places(settings, observation)
        assert 0 < (image > 0).sum() < image.size
        assert_shows(image, area, places, MOVED)
        off_road = contains(judged, places)
        same += int(((image > 0) & off_road).sum())
        both += int(((image > 0) | off_road).sum())
    # The area that off-road driving is judged by has no gaps of decimetres between its lanes.
    assert same / both > 0.99


@pytest.mark.parametrize(
    ("height", "width", "scale", "top", "left"),
    [(40, 90, 1.3, 0.5, 0.2), (200, 31, 0.2, 1.0, 1.0), (1, 1, 5.0, 0.0, 0.5)],
)
def test_images_have_any_form(
    height: int, width: int, scale: float, top: float, left: float
) -> None:
    context = context_on(network("roundabout"))
    settings = RasterSettings(
        height=height,
        width=width,
        metres_per_pixel=scale,
        ego_from_top=top,
        ego_from_left=left,
        channels=(Channel.DRIVABLE,),
    )
    area = area_at(network("roundabout"), 0.0)
    raster = context.raster(settings)
    for observation in poses(context, 4):
        image = raster.draw(observation)
        assert image.shape == (1, height, width)
        assert_shows(image[0], area, pixel_places(settings, observation), MOVED)


@pytest.mark.parametrize("town", TOWNS)
def test_lines_are_where_the_borders_and_centres_of_lanes_are(town: str) -> None:
    context = context_on(network(town))
    wanted = lines_of(network(town))
    settings = RasterSettings(channels=tuple(wanted))
    raster = context.raster(settings)
    half = max(0.5 * LINE_WIDTH, 0.5 * settings.metres_per_pixel)
    images = [(raster.draw(one), pixel_places(settings, one)) for one in poses(context, 5)]
    for index, (channel, lines) in enumerate(wanted.items()):
        near = lines.buffer(half + MOVED)
        # A line is a band of straight pieces: in a bend, a little beside a corner is in neither.
        bands = shapely.buffer(shapely.get_parts(lines), half - MOVED, cap_style="flat")
        inside = shapely.union_all(bands)
        set_pixels = held = needed = 0
        for image, places in images:
            shown, due = image[index] > 0, contains(inside, places)
            assert not (shown & ~contains(near, places)).any(), channel
            set_pixels, needed = set_pixels + int(shown.sum()), needed + int(due.sum())
            held += int((shown & due).sum())
        assert held >= 0.995 * needed, channel
        if channel in (Channel.CENTRE_LINES, Channel.SOLID_LINES):
            assert set_pixels > 0


def lines_of(town: RoadNetwork) -> dict[Channel, BaseGeometry]:
    """Returns the lines of each channel."""
    found: dict[Channel, list[shapely.LineString]] = {
        channel: [] for channel in tuple(Channel)[Channel.CENTRE_LINES : Channel.SPEED_LIMIT]
    }
    for lane, markings in zip(town.lanes, lane_markings(town), strict=True):
        if not lane.drivable:
            continue
        found[Channel.CENTRE_LINES].append(shapely.LineString(lane.shape))
        for marking, side in zip(markings, (1.0, -1.0), strict=True):
            border = shapely.LineString(offset_line(lane.shape, side * 0.5 * lane.width))
            if marking is Marking.BROKEN:
                found[Channel.BROKEN_LINES].append(border)
            elif marking is not Marking.NONE:
                found[Channel.SOLID_LINES].append(border)
    stops = stop_lines(town)
    across = np.stack((-stops.headings[:, 1], stops.headings[:, 0]), axis=1)
    ends = stops.half_widths[:, None] * across
    for row, control in enumerate(line_controls(town)):
        line = shapely.LineString([stops.points[row] - ends[row], stops.points[row] + ends[row]])
        match control:
            case LineControl.SIGNAL:
                found[Channel.SIGNAL_LINES].append(line)
            case LineControl.STOP | LineControl.ALL_WAY_STOP:
                found[Channel.STOP_SIGNS].append(line)
            case LineControl.YIELD:
                found[Channel.GIVE_WAY_SIGNS].append(line)
    return {c: shapely.MultiLineString(lines) for c, lines in found.items() if lines}


def test_the_speed_limit_is_that_of_the_lane() -> None:
    town = network("signal-grid")
    context = context_on(town)
    settings = RasterSettings(channels=(Channel.SPEED_LIMIT,))
    raster = context.raster(settings)
    for observation in poses(context, 6):
        lanes = lanes_around(town, observation)
        places = pixel_places(settings, observation)
        points = shapely.points(*places)
        limits = np.zeros(places[0].shape)
        near_border = np.zeros(places[0].shape, dtype=np.bool_)
        for lane, area in zip(lanes, lane_areas(lanes), strict=True):
            inside = contains(area, places)
            limits[inside] = np.maximum(limits[inside], lane.speed_limit)
            if inside.any():
                near_border |= shapely.distance(area.boundary, points) < MOVED
        image = raster.draw(observation)[0]
        assert np.abs(0.25 * image - limits)[~near_border].max() <= 0.125
        assert image.max() > 0


def raised(town: RoadNetwork, edges: set[str], height: float) -> RoadNetwork:
    """Returns a network with some edges on another level."""
    return replace(
        town,
        lanes=tuple(
            replace(lane, heights=np.full(len(lane.arc), height)) if lane.edge_id in edges else lane
            for lane in town.lanes
        ),
    )


def test_what_is_on_another_level_is_not_shown() -> None:
    ground = network("tee-town")
    ring = {"harbour_0", "-harbour_0"}
    town = raised(ground, ring, LEVEL_GAP + 1.0)
    settings = RasterSettings(channels=(Channel.DRIVABLE, Channel.CENTRE_LINES))
    lane = ground.lane("harbour_0_0")
    x, y, yaw = lane.position_at(60.0)
    flat = context_on(ground).raster(settings).draw(seen_from(x, y, yaw))
    bridge = context_on(town).raster(settings)
    below, above = bridge.draw(seen_from(x, y, yaw)), bridge.draw(seen_from(x, y, yaw, z=5.0))
    on_ring = [lane for lane in town.lanes if lane.drivable and lane.edge_id in ring]
    places = pixel_places(settings, seen_from(x, y, yaw))
    assert_shows(above[0], polygons_of(lane_areas(on_ring)), places, MOVED)
    row, column = 96, 64
    assert flat[0, row, column] == above[0, row, column] == 255
    assert below[0, row, column] == 0
    assert (np.maximum(above, below) == flat).mean() > 0.999
    assert above[1].any()
    # Both levels from between them.
    assert np.array_equal(bridge.draw(seen_from(x, y, yaw, z=2.0)), flat)


def test_a_town_with_bridges_shows_the_level_of_the_ego(shared_data: Path) -> None:
    town = load_network(shared_data / "maps" / "Town04.net.xml", "Town04")
    assert any(lane.heights.max() > LEVEL_GAP for lane in town.lanes)
    settings = RasterSettings(channels=(Channel.DRIVABLE,))
    missing = 0
    for seed in (1, 4):
        context = context_on(town, seed)
        raster = context.raster(settings)
        for observation in poses(context, seed):
            image = raster.draw(observation)[0] > 0
            places = pixel_places(settings, observation)
            z = float(observation.ego[-1])
            whole = contains(area_at(town, z, observation), places)
            # A long ramp is on the level in parts: no pixel too many, and few fewer.
            assert not (image & ~whole).mean() > 1e-3
            missing += int((whole & ~image).sum())
            assert (image & whole).sum() > 0.5 * whole.sum()
    assert missing > 0


def test_a_step_looks_at_few_items_of_a_large_network() -> None:
    context = context_on(network("highway"))
    raster = BirdsEyeRaster(context, RasterSettings())
    items = raster_map(network("highway"))
    for observation in poses(context, 7):
        raster.draw(observation)
        drawn = int((raster._scratch.area_turns == raster._turn).sum())
        assert 0 < drawn < 0.1 * len(items.circles)


def test_a_map_is_made_once_for_all_runs() -> None:
    assert raster_map(network("tee-town")) is raster_map(network("tee-town"))


def test_a_network_is_drawn_the_same_from_both_sides_of_a_turn() -> None:
    context = context_on(network("tee-town"))
    raster = context.raster(RasterSettings(ego_from_top=0.5, channels=(Channel.DRIVABLE,)))
    x, y, yaw = on_route(context.route, 60.0)
    one = raster.draw(seen_from(x, y, yaw))[0]
    other = raster.draw(seen_from(x, y, yaw + math.pi))[0]
    assert (one != other[::-1, ::-1]).mean() < 1e-3
