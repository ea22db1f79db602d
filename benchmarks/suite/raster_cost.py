"""The cost of a bird's-eye raster for an agent."""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from benchmarks.suite.measurement import Measurement, Plan, Round, Sample, sample
from drivora_service.agents.interface import AgentContext, Observation
from drivora_service.agents.log import AgentLog
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.networks.heights import line_heights
from drivora_service.networks.network_loading import load_network
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.networks.routes.routing import RoutePoint, plan_route
from drivora_service.observations.trace import Col
from drivora_service.scenario.models.actor_models import ActorKind, actor_model
from drivora_service.scenario.seed_generation import DEFAULT_MODEL, generate_seeds

ACTORS = (0, 20, 200)
REAL_TOWNS = ("Town01", "Town04")
_PLACES = 100
_REACH = 50.0
"""Metres around the ego within which the actors are: nearly all of them are in the image."""


@contextmanager
def _open(plan: Plan) -> Iterator[Round]:
    shipped = NetworkCatalogue(shipped_networks())
    towns = [shipped.get(name) for name in (("signal-grid",) if plan.short else shipped.names())]
    if plan.networks is None:
        plan.remarks.append("Real towns are left out: their folder was not given.")
    else:
        paths = [plan.networks / f"{name}.net.xml" for name in REAL_TOWNS]
        towns += [load_network(path, name) for path, name in zip(paths, REAL_TOWNS, strict=True)]
    cases = []
    for town in towns:
        context = _context(town)
        raster = context.raster()
        places = {actors: _observations(context, actors) for actors in ACTORS}
        cases.append((town.name, raster, np.zeros(raster.settings.shape, np.uint8), places))

    def once() -> Iterator[Sample]:
        for town, raster, out, places in cases:
            for actors, observations in places.items():
                took = []
                for observation in observations:
                    begun = time.perf_counter()
                    raster.draw(observation, out)
                    took.append(time.perf_counter() - begun)
                median = 1e3 * statistics.median(took)
                yield sample(town, f"an image with {actors} actors", median, "ms")

    yield once


def _context(town: RoadNetwork) -> AgentContext:
    document = next(
        generate_seeds(town, count=1, min_length=300.0, max_length=600.0, seed=1, agent="idm")
    )
    points = [RoutePoint(x=p.x, y=p.y) for p in document.ego_vehicles[0].route]
    return AgentContext(
        ego_id="ego",
        model=actor_model(ActorKind.VEHICLE, DEFAULT_MODEL),
        network=town,
        route=plan_route(town, points),
        step_length=0.05,
        friction=1.0,
        seed=1,
        parameters={},
        log=AgentLog(),
    )


def _observations(context: AgentContext, actors: int) -> list[Observation]:
    """Returns observations along the route, with actors anywhere around the ego."""
    random, route = np.random.default_rng(actors), context.route
    heights = line_heights(context.network, route.line, route.point_lanes)
    found = []
    for s in np.linspace(0.0, route.length, _PLACES, endpoint=False).tolist():
        i = int(np.searchsorted(route.arc, s, side="right"))
        step = route.line[i] - route.line[i - 1]
        ego = np.zeros(len(Col))
        ego[: Col.YAW] = route.line[i]
        ego[Col.YAW], ego[Col.Z] = math.atan2(step[1], step[0]), heights[i]
        objects = np.tile(ego, (actors, 1))
        objects[:, : Col.YAW] += random.uniform(-_REACH, _REACH, (actors, 2))
        objects[:, Col.YAW] = random.uniform(-math.pi, math.pi, actors)
        found.append(
            Observation(
                ego=ego,
                route_s=s,
                time=s,
                objects=objects,
                object_sizes=np.tile([4.5, 1.9], (actors, 1)),
                object_kinds=random.integers(0, 3, actors),
                object_ids=np.arange(actors),
            )
        )
    return found


RASTER_COST = Measurement(
    name="raster",
    title="Cost of a bird's-eye raster",
    about="Median wall time of one image of 128 x 128 pixels of 0.5 m with all channels, at "
    f"{_PLACES} places of a route, with 0 to 200 actors within {_REACH:g} m of the ego in both "
    "directions. The map is made before.",
    open=_open,
)
