"""Contexts, observations and pixel places for tests of rasters."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import shapely
import shapely.affinity
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from drivora_service.agents.interface import AgentContext, Observation
from drivora_service.agents.log import AgentLog
from drivora_service.agents.raster.raster_settings import RasterSettings
from drivora_service.geometry.array_shapes import BoolArray, ByteArray, FloatArray
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.networks.routes.lane_route import LaneRoute
from drivora_service.networks.routes.routing import RoutePoint, plan_route
from drivora_service.observations.trace import Col
from drivora_service.scenario.models.actor_models import ActorKind, actor_model
from drivora_service.scenario.seed_generation import generate_seeds
from tests.simulation.episodes import CAR


def context_on(network: RoadNetwork, seed: int = 1) -> AgentContext:
    """Returns the context of a random route of 150 to 400 m."""
    options: dict[str, Any] = {"count": 1, "min_length": 150.0, "max_length": 400.0}
    document = next(iter(generate_seeds(network, seed=seed, agent="idm", **options)))
    points = [RoutePoint(x=p.x, y=p.y) for p in document.ego_vehicles[0].route]
    return AgentContext(
        ego_id="ego",
        model=actor_model(ActorKind.VEHICLE, CAR),
        network=network,
        route=plan_route(network, points),
        step_length=0.05,
        friction=1.0,
        seed=seed,
        parameters={},
        log=AgentLog(),
    )


def seen_from(
    x: float, y: float, yaw: float, *, objects: FloatArray | None = None, **more: Any
) -> Observation:
    """Returns an observation at a place; ``objects`` are rows of x, y, yaw, length, width, kind."""
    rows = np.zeros((0, 6)) if objects is None else np.asarray(objects, dtype=np.float64)
    states = np.zeros((len(rows), len(Col)))
    states[:, : Col.YAW + 1] = rows[:, :3]
    ego = np.zeros(len(Col))
    ego[: Col.YAW + 1] = x, y, yaw
    ego[Col.Z] = more.pop("z", 0.0)
    states[:, Col.Z] = more.pop("objects_z", ego[Col.Z])
    return Observation(
        ego=ego,
        objects=states,
        object_sizes=rows[:, 3:5].copy(),
        object_kinds=rows[:, 5].astype(np.int64),
        object_ids=np.arange(len(rows)),
        **more,
    )


def on_route(route: LaneRoute, s: float) -> tuple[float, float, float]:
    """Returns x, y and heading of a place on a route."""
    x, y = (float(np.interp(s, route.arc, route.line[:, k])) for k in (0, 1))
    i = min(int(np.searchsorted(route.arc, s, side="right")), len(route.line) - 1)
    step = route.line[i] - route.line[i - 1]
    return x, y, math.atan2(step[1], step[0])


def pixel_places(settings: RasterSettings, observation: Observation) -> tuple[FloatArray, ...]:
    """Returns the (height, width) x and y of all pixels' centres, metres."""
    x, y, yaw = observation.ego[: Col.YAW + 1].tolist()
    ahead, left = np.meshgrid(settings.rows_ahead, settings.columns_left, indexing="ij")
    cos, sin = math.cos(yaw), math.sin(yaw)
    return x + ahead * cos - left * sin, y + ahead * sin + left * cos


def assert_shows(
    image: ByteArray, area: BaseGeometry, places: tuple[FloatArray, ...], within: float = 1e-6
) -> None:
    """Asserts that the pixels that are set are those whose centres are in an area.

    Args:
        image: (height, width).
        area: Polygons.
        places: x and y of the pixels' centres.
        within: Metres from the area's border within which a pixel may be either.
    """
    assert set(np.unique(image).tolist()) <= {0, 255}
    wrong = (image > 0) != contains(area, places)
    if wrong.any():
        points = shapely.points(places[0][wrong], places[1][wrong])
        assert shapely.distance(area.boundary, points).max() <= within


def contains(area: BaseGeometry, places: tuple[FloatArray, ...]) -> BoolArray:
    """Returns which places are in an area."""
    shapely.prepare(area)
    found: NDArray[np.bool_] = shapely.contains_xy(area, *places)
    return found


def polygons_of(parts: list[BaseGeometry]) -> BaseGeometry:
    """Returns the union of the polygons among geometries and their parts."""
    flat = shapely.get_parts(np.array(parts, dtype=np.object_))
    return shapely.union_all(flat[shapely.area(flat) > 0.0])


def corners_of(row: FloatArray) -> FloatArray:
    """Returns the (5, 2) corners of a box, a row of x, y, yaw, length and width, closed."""
    x, y, yaw, length, width = row[:5].tolist()
    box = shapely.box(-0.5 * length, -0.5 * width, 0.5 * length, 0.5 * width)
    turned = shapely.affinity.rotate(box, yaw, origin=(0.0, 0.0), use_radians=True)
    return shapely.get_coordinates(shapely.affinity.translate(turned, x, y))
