"""What rasters show of the route, of lights and of actors, and how they behave."""

from __future__ import annotations

import cmath
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.path import Path as Outline
from scipy import ndimage

from drivora_service.agents.interface import AccelerationControl, AgentContext, Observation
from drivora_service.agents.raster.raster_settings import Channel, Raster, RasterSettings
from drivora_service.errors import AgentError
from drivora_service.geometry.array_shapes import BoolArray, ByteArray, FloatArray
from drivora_service.observations.trace import LEVEL_GAP, Light
from drivora_service.scenario.model import Weather
from tests.agents.raster.scenes import (
    context_on,
    corners_of,
    on_route,
    pixel_places,
    seen_from,
)
from tests.simulation.episodes import (
    car,
    ego,
    network,
    place,
    run,
    scenario,
    walker,
)

ACTORS = (Channel.VEHICLES, Channel.WALKERS, Channel.OBSTACLES, Channel.EGO)
ROW, COLUMN = 96, 64
"""Pixel whose upper left corner is the ego's centre, in an image of the usual form."""


@pytest.fixture(scope="module")
def context() -> AgentContext:
    return context_on(network("tee-town"))


@pytest.fixture(scope="module")
def actors(context: AgentContext) -> Raster:
    return context.raster(RasterSettings(channels=ACTORS))


def boxes(*rows: tuple[float, float, float, float, float, int]) -> FloatArray:
    """Rows of x, y, yaw, length, width, kind."""
    return np.array(rows, dtype=np.float64).reshape(-1, 6)


def test_ahead_is_up_and_left_is_left(actors: Raster) -> None:
    for yaw in np.linspace(-3.0, 3.0, 7).tolist():
        cos, sin = math.cos(yaw), math.sin(yaw)
        ahead = (20.0 + 30.0 * cos, 10.0 + 30.0 * sin, yaw, 4.0, 2.0, 0)
        left = (20.0 - 12.0 * sin, 10.0 + 12.0 * cos, yaw, 1.0, 1.0, 1)
        behind = (20.0 - 10.0 * cos, 10.0 - 10.0 * sin, yaw, 2.0, 2.0, 2)
        image = actors.draw(seen_from(20.0, 10.0, yaw, objects=boxes(ahead, left, behind)))
        middles = [np.argwhere(plane).mean(axis=0) + 0.5 for plane in image]
        expected = [(ROW - 60, COLUMN), (ROW, COLUMN - 24), (ROW + 20, COLUMN), (ROW, COLUMN)]
        np.testing.assert_allclose(middles, expected, atol=0.6)


def test_the_ego_is_as_large_as_its_vehicle(context: AgentContext, actors: Raster) -> None:
    area = (actors.draw(seen_from(0.0, 0.0, 0.7))[3] > 0).sum() * 0.25
    assert area == pytest.approx(context.model.length * context.model.width, rel=0.1)


rows = st.tuples(
    st.floats(-60.0, 60.0),
    st.floats(-60.0, 60.0),
    st.floats(-7.0, 7.0),
    st.floats(0.2, 18.0),
    st.floats(0.2, 3.0),
    st.integers(0, 2),
)


@settings(max_examples=60)
@given(
    objects=st.lists(rows, max_size=6),
    pose=st.tuples(st.floats(-1e4, 1e4), st.floats(-1e4, 1e4), st.floats(-7.0, 7.0)),
)
def test_a_pixel_shows_an_actor_if_its_centre_is_in_the_box(
    actors: Raster, objects: list[tuple[float, ...]], pose: tuple[float, float, float]
) -> None:
    found = np.array(objects).reshape(-1, 6)
    found[:, :2] += pose[:2]
    observation = seen_from(*pose, objects=found)
    image = actors.draw(observation) > 0
    places = pixel_places(actors.settings, observation)
    centres = np.column_stack([axis.ravel() for axis in places])
    for kind in range(3):
        certain, possible = np.zeros((2, *image.shape[1:]), dtype=np.bool_)
        for row in found[found[:, 5] == kind]:
            outline = Outline(corners_of(row))
            wide, narrow = (
                outline.contains_points(centres, radius=by).reshape(certain.shape)
                for by in (1e-6, -1e-6)
            )
            certain |= wide & narrow
            possible |= wide | narrow
            # The pixel of the box's centre, so that small actors are shown.
            from_ego = complex(row[0] - pose[0], row[1] - pose[1]) * cmath.exp(-1j * pose[2])
            exact = np.array([ROW - 2.0 * from_ego.real, COLUMN - 2.0 * from_ego.imag])
            pixel = tuple(np.floor(exact).astype(int).tolist())
            if all(0 <= index < 128 for index in pixel):
                possible[pixel] = True
                certain[pixel] |= bool(np.abs(exact - np.round(exact)).min() > 1e-6)
        assert not (certain & ~image[kind]).any()
        # At the border of two pixels, the centre may be in either.
        assert (image[kind] & ~possible).sum() <= len(found)
        assert not (image[kind] & ~possible & ~grown(possible)).any()


def grown(mask: BoolArray) -> BoolArray:
    """Returns a mask with the pixels beside those that are set."""
    more = mask.copy()
    more[1:] |= mask[:-1]
    more[:-1] |= mask[1:]
    more[:, 1:] |= more[:, :-1]
    more[:, :-1] |= more[:, 1:]
    return more


@settings(max_examples=30)
@given(
    objects=st.lists(rows, min_size=1, max_size=6),
    moved=st.tuples(st.floats(-1e3, 1e3), st.floats(-1e3, 1e3)),
    turned=st.floats(-3.0, 3.0),
)
def test_moving_and_turning_everything_changes_nothing(
    actors: Raster,
    objects: list[tuple[float, ...]],
    moved: tuple[float, float],
    turned: float,
) -> None:
    here = np.array(objects).reshape(-1, 6)
    there = here.copy()
    places = (here[:, 0] + 1j * here[:, 1]) * cmath.exp(1j * turned) + complex(*moved)
    there[:, 0], there[:, 1], there[:, 2] = places.real, places.imag, here[:, 2] + turned
    one = actors.draw(seen_from(0.0, 0.0, 0.0, objects=here))
    other = actors.draw(seen_from(*moved, turned, objects=there))
    # Rounding decides of centres that are exactly on a border.
    borders = np.round(4.0 * here[:, :5], 6)
    if not np.isclose(borders, np.round(borders)).any():
        assert (one != other).sum() <= 2


def test_many_actors_are_all_shown(actors: Raster) -> None:
    grid = [(4.0 * i, 4.0 * j, 0.3, 1.0, 1.0, 0) for i in range(-3, 10) for j in range(-7, 8)]
    image = actors.draw(seen_from(0.0, 0.0, 0.0, objects=boxes(*grid)))
    assert ndimage.label(image[0])[1] == len(grid)


def test_actors_on_another_level_are_left_out(actors: Raster) -> None:
    objects = boxes((10.0, 0.0, 0.0, 4.0, 2.0, 0), (20.0, 0.0, 0.0, 4.0, 2.0, 0))
    heights = np.array([LEVEL_GAP + 0.1, LEVEL_GAP - 0.1])
    image = actors.draw(seen_from(0.0, 0.0, 0.0, objects=objects, objects_z=heights))
    assert not image[0, ROW - 25 : ROW - 15].any()
    assert image[0, ROW - 45 : ROW - 35].any()


def test_earlier_images_show_actors_where_they_were(context: AgentContext) -> None:
    channels = (Channel.OBSTACLES, Channel.VEHICLES, Channel.EGO)
    raster = context.raster(RasterSettings(channels=channels, history=(0.1, 0.5)))
    assert raster.settings.names == (
        "obstacles", "vehicles", "ego", "vehicles@-0.1", "ego@-0.1", "vehicles@-0.5", "ego@-0.5",
    )  # fmt: skip

    def at(step: int) -> Observation:
        other = boxes((30.0 + step, 0.0, 0.0, 4.0, 2.0, 0))
        return seen_from(0.5 * step, 0.0, 0.0, objects=other, time=0.05 * step, step=step)

    for step in range(30):
        image = raster.draw(at(step))
        if step < 10:
            assert not image[5:].any()
    middles = [np.argwhere(plane).mean(axis=0)[0] + 0.5 for plane in image[1:]]
    # At the last step, the ego is at 14.5 m and the other at 59 m; a pixel is half a metre.
    ahead = np.array([44.5, 0.0, 42.5, -1.0, 34.5, -5.0])
    np.testing.assert_allclose(middles, ROW - 2.0 * ahead, atol=0.6)


def test_the_route_is_shown_near_the_ego_as_wide_as_its_lanes(context: AgentContext) -> None:
    channels = RasterSettings(channels=(Channel.ROUTE,))
    raster = context.raster(channels)
    route, lanes = context.route, context.network.lanes
    widths = {lanes[lane].width for lane in route.point_lanes.tolist()}
    for s in np.linspace(5.0, route.length - 5.0, 8).tolist():
        observation = seen_from(*on_route(route, s), route_s=s)
        image = raster.draw(observation)[0] > 0
        points = shapely.points(*pixel_places(channels, observation))
        # What is further along the route than 87 m is another part of it.
        gaps, wide = (
            shapely.distance(shapely.LineString(route.line[np.abs(route.arc - s) < reach]), points)
            for reach in (85.0, 90.0)
        )
        ends = np.array([[*route.line[0]], [*route.line[-1]]])
        at_end = shapely.distance(shapely.MultiPoint(ends), points) < 3.0
        assert image[(gaps < 0.5 * min(widths) - 0.05) & ~at_end].all()
        assert not image[wide > 0.5 * max(widths) + 0.3].any()


def test_a_later_part_of_the_route_is_not_shown(context: AgentContext) -> None:
    raster = context.raster(RasterSettings(channels=(Channel.ROUTE,)))
    # The ego is at the begin of the route, and is said to be 150 m further.
    observation = seen_from(*on_route(context.route, 0.0), route_s=context.route.length + 150.0)
    assert not raster.draw(observation).any()


LIGHTS = (Channel.RED, Channel.YELLOW, Channel.GREEN)


@pytest.mark.parametrize(
    ("light", "index"), [(Light.RED, 0), (Light.YELLOW, 1), (Light.GREEN, 2), (Light.NONE, None)]
)
def test_the_next_light_is_shown_at_its_stop_line(light: Light, index: int | None) -> None:
    grid = network("signal-grid")
    context = next(c for c in (context_on(grid, seed) for seed in range(1, 9)) if c.route.signals)
    raster = context.raster(RasterSettings(channels=LIGHTS))
    signal = context.route.signals[0]
    lane = grid.lanes[
        next(
            number
            for number in context.route.runs[signal.run].lanes
            if any(link.link_index == signal.link_index for link in grid.lanes[number].connections)
            and grid.lanes[number].connections[0].traffic_light == signal.traffic_light
        )
    ]
    s = max(signal.s - 30.0, 0.0)
    observation = seen_from(
        *on_route(context.route, s),
        route_s=s,
        light=light,
        light_distance=signal.s - s - 0.5 * context.model.length,
    )
    image = raster.draw(observation)
    shown = [bool(plane.any()) for plane in image]
    assert shown == [number == index for number in range(3)]
    if index is not None:
        places = pixel_places(raster.settings, observation)
        found = np.array([places[0][image[index] > 0].mean(), places[1][image[index] > 0].mean()])
        assert np.hypot(*(found - lane.shape[-1])) < 0.5
        spread = np.hypot(np.ptp(places[0][image[index] > 0]), np.ptp(places[1][image[index] > 0]))
        assert spread == pytest.approx(lane.width, abs=0.8)


def test_images_are_independent_and_repeatable(context: AgentContext) -> None:
    objects = boxes((12.0, 3.0, 0.4, 4.0, 2.0, 0), (5.0, -6.0, 0.0, 0.6, 0.6, 1))
    views = []
    for s in (10.0, 40.0, 80.0):
        x, y, yaw = on_route(context.route, s)
        moved = objects + np.array([x, y, 0.0, 0.0, 0.0, 0.0])
        views.append(seen_from(x, y, yaw, objects=moved, route_s=s, time=s))
    one, other = context.raster(), context.raster()
    first = [one.draw(view) for view in views]
    kept = [image.copy() for image in first]
    before = [view.objects.copy() for view in views]
    for view, image in zip(reversed(views), reversed(kept), strict=True):
        assert np.array_equal(other.draw(view), image)
    for image in first:
        assert not any(np.shares_memory(image, more) for more in first if more is not image)
        image.fill(7)
    out = np.full(one.settings.shape, 9, dtype=np.uint8)
    for view, image, objects in zip(views, kept, before, strict=True):
        assert one.draw(view, out) is out
        assert np.array_equal(out, image)
        assert np.array_equal(view.objects, objects)


@pytest.mark.parametrize(
    "out",
    [
        np.zeros((16, 128, 127), dtype=np.uint8),
        np.zeros((16, 128, 128), dtype=np.float32),
        np.zeros((16, 128, 256), dtype=np.uint8)[:, :, ::2],
    ],
)
def test_an_array_that_does_not_fit_is_refused(context: AgentContext, out: ByteArray) -> None:
    with pytest.raises(AgentError, match=r"needed: uint8, \(16, 128, 128\), contiguous"):
        context.raster().draw(seen_from(0.0, 0.0, 0.0), out)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"height": 0}, "height is 0; allowed: 1 to 1024 pixels"),
        ({"width": 1.5}, "width is 1.5; allowed: 1 to 1024"),
        ({"metres_per_pixel": float("nan")}, "metres_per_pixel is nan; allowed: more than 0"),
        ({"ego_from_top": 96}, "ego_from_top is 96; allowed: 0 to 1, a share"),
        ({"channels": ()}, "channels is \\(\\); allowed: one or more.* Channel.DRIVABLE"),
        ({"channels": (Channel.EGO, Channel.EGO)}, "allowed: one or more, each once"),
        ({"channels": ("route",)}, r"found|channels is \('route',\)"),
        ({"history": (0.5, -1.0)}, "history is .*; allowed: seconds before now"),
        ({"height": 1024, "width": 1024}, "16 \\* 1024 \\* 1024"),
    ],
)
def test_settings_that_are_not_allowed_are_refused(wrong: dict[str, Any], message: str) -> None:
    with pytest.raises(AgentError, match=message):
        RasterSettings(**wrong)


def test_a_channel_that_a_raster_does_not_have_is_named() -> None:
    chosen = RasterSettings(channels=(Channel.ROUTE, Channel.EGO))
    assert chosen.index(Channel.EGO) == 1
    with pytest.raises(AgentError, match="no channel 'red'; it has: route, ego"):
        chosen.index(Channel.RED)


class Seeing:
    """Stands still and keeps its images."""

    def setup_env(self, context: AgentContext) -> None:
        self.raster = context.raster(RasterSettings(channels=ACTORS))
        self.images: list[ByteArray] = []
        self.objects: list[int] = []

    def run_step(self, observation: Observation) -> AccelerationControl:
        self.images.append(self.raster.draw(observation))
        self.objects.append(len(observation.objects))
        return AccelerationControl(-8.0, 0.0)


@pytest.mark.parametrize("is_hidden", [True, False])
def test_only_what_the_ego_perceives_is_shown(is_hidden: bool) -> None:
    lane = "harbour_1_0"
    beyond = walker(place(lane, 42.0), place(lane, 42.5, speed=0.01), name="walker")
    van = replace(
        car(place(lane, 30.0), place(lane, 31.0, speed=0.0)), model="vehicle.carlamotors.firetruck"
    )
    agent = Seeing()
    others: dict[str, Any] = {"npc_walkers": (beyond,)}
    if is_hidden:
        others["npc_vehicles"] = (van,)
    run(scenario(ego(place(lane, 15.0), place(lane, 120.0)), seconds=1.0, **others), agent)
    assert set(agent.objects) == {1}
    for image in agent.images:
        assert image[0].any() == is_hidden
        assert image[1].any() != is_hidden


def test_noise_moves_actors_in_the_image_as_in_the_observation() -> None:
    lane = "harbour_1_0"
    agent = Seeing()
    fog = Weather(fog_density=60.0, precipitation=80.0)
    other = car(place(lane, 30.0), place(lane, 31.0, speed=0.0))
    what = scenario(
        ego(place(lane, 15.0), place(lane, 120.0)), npc_vehicles=(other,), seconds=2.0, weather=fog
    )
    run(what, agent)
    seen = [image[0] for image in agent.images if image[0].any()]
    assert len(seen) == sum(agent.objects)
    assert len({tuple(np.argwhere(image).mean(axis=0).tolist()) for image in seen}) >= 3
