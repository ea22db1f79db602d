"""Seed scenarios: random ego routes of a given length on a network.

A route is found by a random walk over the lane graph: from a random place on a random lane through
random connections until the wanted length is driven. So every candidate is drivable, and its length
is known; what remains is to check that the planner finds the same way from start to destination.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator

import numpy as np

from drivora_service.errors import InvalidDocument, NetworkError, NoRoute, Problem
from drivora_service.networks.road_network import Lane, RoadNetwork
from drivora_service.networks.routes.routing import RoutePoint, plan_route
from drivora_service.networks.routes.tight_turns import tight_turns, uses_tight_turn
from drivora_service.scenario.documents import ScenarioDocument
from drivora_service.scenario.entities import (
    AgentDocument,
    EgoDocument,
    MapRegionDocument,
    WaypointDocument,
    is_agent_name,
)

DEFAULT_MODEL = "vehicle.lincoln.mkz_2017"
MAX_SEEDS = 10_000
MAX_LENGTH = 100_000.0
_PATIENCE = 500
"""Consecutive rejected candidates after which the search ends."""
_END_MARGIN = 6.0
"""Metres that start and destination keep from the ends of their lanes, if these are longer."""
_MIN_DIFFERENCE = 5.0
"""Metres by which the starts or the destinations of two seeds must differ."""


def generate_seeds(
    network: RoadNetwork,
    *,
    count: int,
    min_length: float,
    max_length: float,
    seed: int,
    agent: str,
) -> Iterator[ScenarioDocument]:
    """Returns ``count`` distinct scenarios with one ego, which depend on the arguments only.

    Args:
        network: The road network.
        count: Number of scenarios.
        min_length: Minimum length of the route, metres.
        max_length: Maximum length of the route, metres.
        seed: Seed of the random draws, and part of each scenario's seed.
        agent: Agent that drives the egos.

    Raises:
        InvalidDocument: The options contradict one another.
        NetworkError: The network does not have enough such routes; with the reasons of the
            rejections. Raised after the seeds that could be found.
    """
    _check_options(count, min_length, max_length, seed, agent)
    return _generate(network, count, min_length, max_length, seed, agent)


def _check_options(count: int, min_length: float, max_length: float, seed: int, agent: str) -> None:
    problems = []
    if not 1 <= count <= MAX_SEEDS:
        problems.append(_option("count", f"found {count}; 1 to {MAX_SEEDS} are allowed"))
    if not min_length >= 5.0:
        problems.append(_option("min_length", f"found {min_length}; at least 5 m are needed"))
    if not min_length <= max_length <= MAX_LENGTH:
        message = f"found {max_length}; {min_length:g} (min_length) to {MAX_LENGTH:g} m are allowed"
        problems.append(_option("max_length", message))
    if not 0 <= seed < 2**31:
        problems.append(_option("seed", f"found {seed}; 0 to {2**31 - 1} are allowed"))
    if not is_agent_name(agent):
        problems.append(_option("agent", f"{agent!r} cannot be the name of an agent"))
    if problems:
        raise InvalidDocument(tuple(problems))


def _option(name: str, message: str) -> Problem:
    return Problem(pointer=f"/{name}", code="option", message=message)


def _generate(
    network: RoadNetwork, count: int, min_length: float, max_length: float, seed: int, agent: str
) -> Iterator[ScenarioDocument]:
    random = np.random.default_rng(seed)
    starts = [lane for lane in network.lanes if lane.drivable and not lane.is_internal]
    if not starts:
        raise NetworkError(f"{network.name} has no lane that is open to cars")
    weights = np.array([float(lane.arc[-1]) for lane in starts])
    weights /= weights.sum()
    refused: Counter[str] = Counter()
    found: list[tuple[float, float, float, float]] = []
    misses = 0
    while len(found) < count and misses < _PATIENCE:
        lane = starts[int(random.choice(len(starts), p=weights))]
        wanted = float(random.uniform(min_length, max_length))
        route = _walk(network, lane, wanted, random)
        reason = _refusal(network, route, min_length, max_length, found)
        if reason is not None or route is None:
            refused[reason or _DEAD_END] += 1
            misses += 1
            continue
        misses = 0
        start, destination = route
        found.append((start.x, start.y, destination.x, destination.y))
        yield _document(network, start, destination, seed + len(found) - 1, agent)
    if len(found) < count:
        reasons = "; ".join(f"{reason}: {times}" for reason, times in refused.most_common())
        raise NetworkError(
            f"found {len(found)} of {count} routes of {min_length:g} to {max_length:g} m on "
            f"{network.name}; the last {_PATIENCE} candidates were all refused. Refused in all: "
            f"{reasons}. Ask for fewer, or for another length"
        )


_DEAD_END = "the road ends before the wanted length"


def _walk(
    network: RoadNetwork, lane: Lane, wanted: float, random: np.random.Generator
) -> tuple[RoutePoint, RoutePoint] | None:
    """Drives ``wanted`` metres from a random place on ``lane``; ``None`` in a dead end.

    A turn that no car can drive counts as a dead end.
    """
    tight = tight_turns(network)
    margin = min(_END_MARGIN, 0.25 * float(lane.arc[-1]))
    s = float(random.uniform(margin, float(lane.arc[-1]) - margin))
    start = _point(lane, s)
    left = wanted
    while s + left > float(lane.arc[-1]):
        ways = [c for c in lane.connections if network.lanes[c.to_lane].drivable]
        ways = [c for c in ways if (lane.index, c.to_lane) not in tight]
        if not ways:
            return None
        left -= float(lane.arc[-1]) - s
        s = 0.0
        lane = network.lanes[ways[int(random.integers(len(ways)))].to_lane]
    # A destination inside a junction is moved to the road behind it.
    s += left
    while lane.is_internal and lane.connections:
        lane, s = network.lanes[lane.connections[0].to_lane], 0.0
    margin = min(_END_MARGIN, 0.25 * float(lane.arc[-1]))
    return start, _point(lane, min(max(s, margin), float(lane.arc[-1]) - margin))


def _point(lane: Lane, s: float) -> RoutePoint:
    x, y, yaw = lane.position_at(s)
    return RoutePoint(x=round(x, 2), y=round(y, 2), yaw=round(yaw, 4))


def _refusal(
    network: RoadNetwork,
    route: tuple[RoutePoint, RoutePoint] | None,
    min_length: float,
    max_length: float,
    found: list[tuple[float, float, float, float]],
) -> str | None:
    """Returns why a candidate is rejected; ``None`` if it is a seed."""
    if route is None:
        return _DEAD_END
    start, destination = route
    for x, y, to_x, to_y in found:
        near_start = math.hypot(start.x - x, start.y - y) < _MIN_DIFFERENCE
        if near_start and math.hypot(destination.x - to_x, destination.y - to_y) < _MIN_DIFFERENCE:
            return "too similar to an earlier seed"
    try:
        planned = plan_route(network, route)
    except NoRoute:
        return "no drivable way"
    if uses_tight_turn(network, planned):
        return "the way turns more tightly than a car can"
    length = planned.length
    if length < min_length:
        return "the direct way is too short"
    return "the way is too long" if length > max_length else None


def _document(
    network: RoadNetwork, start: RoutePoint, destination: RoutePoint, seed: int, agent: str
) -> ScenarioDocument:
    return ScenarioDocument(
        ego_vehicles=(
            EgoDocument(
                id="ego_0",
                model=DEFAULT_MODEL,
                route=(_waypoint(start), _waypoint(destination)),
                agent=AgentDocument(name=agent),
            ),
        ),
        map_region=MapRegionDocument(town=network.name),
        seed=seed % 2**31,
    )


def _waypoint(point: RoutePoint) -> WaypointDocument:
    yaw = None if point.yaw is None else round(math.degrees(point.yaw), 2)
    return WaypointDocument(x=point.x, y=point.y, yaw=yaw)
