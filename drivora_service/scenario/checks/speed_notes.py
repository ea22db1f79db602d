"""Notes on speeds and accelerations far beyond what the road or the model allows."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from drivora_service.networks.road_network import RoadNetwork
from drivora_service.scenario.checks.noted_figures import (
    FAST_FACTOR,
    limit_near,
    other_unit,
    placed,
    speed_words,
)
from drivora_service.scenario.model import EgoVehicle, NpcVehicle, NpcWalker, Scenario, Waypoint
from drivora_service.scenario.models.actor_models import ActorKind, actor_model
from drivora_service.scenario.waypoint_speeds import GRAVITY

FAST_WALKER = 5.0
"""m/s of a person who runs; methods vary walkers up to less."""
HARD_BRAKING = 1.7
"""How many times the braking of its model a vehicle may be asked for without being noted."""

Tokens = tuple[str | int, ...]


def speed_notes(
    scenario: Scenario, network: RoadNetwork, *, with_agents: bool = True
) -> Iterator[str]:
    """Yields a note for each actor with such a speed or acceleration, its first one.

    Args:
        scenario: The scenario.
        network: Its road network.
        with_agents: Whether the parameters of its agents are looked at; not if others drive.
    """
    for index, ego in enumerate(scenario.ego_vehicles):
        place: Tokens = ("ego_vehicles", index)
        yield from _start_note(place, ego, network)
        yield from _route_note(place, ego.route, network)
        yield from _path_note(place, ego)
        if with_agents:
            own: Tokens = (*place, "agent", "parameters")
            yield from wanted_speed_notes(own, ego.agent.parameters, (ego,), network)
    for index, npc in enumerate(scenario.npc_vehicles):
        place = ("npc_vehicles", index)
        yield from _route_note(place, npc.route, network)
        yield from _acceleration_notes(place, npc)
    for index, walker in enumerate(scenario.npc_walkers):
        yield from _walker_note(("npc_walkers", index), walker)


def wanted_speed_notes(
    place: Tokens,
    parameters: Mapping[str, Any],
    egos: Sequence[EgoVehicle],
    network: RoadNetwork,
) -> Iterator[str]:
    """Yields notes on the speeds among the parameters of an agent.

    Args:
        place: Where the parameters are.
        parameters: Parameters of the agent.
        egos: The egos that it drives.
        network: The road network.
    """
    limits = [limit for ego in egos if (limit := _limit_at(ego.route[0], network)) is not None]
    if not limits:
        return
    limit = max(limits)
    for name, value in parameters.items():
        is_speed = name == "speed" or name.endswith("_speed")
        is_number = isinstance(value, int | float) and not isinstance(value, bool)
        if is_speed and is_number and value > FAST_FACTOR * limit:
            yield placed(
                (*place, name),
                f"{value:g}, in m/s {value * 3.6:.3g} km/h; the lane at the start of its ego "
                f"allows {speed_words(limit)}; speeds of Drivora are in m/s",
            )


def _start_note(place: Tokens, ego: EgoVehicle, network: RoadNetwork) -> Iterator[str]:
    speed, limit = ego.initial_speed, _limit_at(ego.route[0], network)
    if limit is not None and speed > FAST_FACTOR * limit:
        yield placed(
            (*place, "initial_speed"),
            f"ego {ego.id!r} starts at {speed_words(speed)}; the lane there allows "
            f"{speed_words(limit)}; {other_unit(speed)}",
        )


def _route_note(place: Tokens, route: Sequence[Waypoint], network: RoadNetwork) -> Iterator[str]:
    """Yields a note on the first waypoint with such a speed, and the number of the others."""
    least = FAST_FACTOR * min(lane.speed_limit for lane in network.lanes)
    fast = [
        (number, point.speed, limit)
        for number, point in enumerate(route)
        if point.speed is not None
        and point.speed > least
        and (limit := _limit_at(point, network)) is not None
        and point.speed > FAST_FACTOR * limit
    ]
    if not fast:
        return
    number, speed, limit = fast[0]
    more = f"; {len(fast) - 1} more of its waypoints are like it" if len(fast) > 1 else ""
    yield placed(
        (*place, "route", number, "speed"),
        f"{speed_words(speed)}; the lane there allows {speed_words(limit)}; "
        f"{other_unit(speed)}{more}",
    )


def _path_note(place: Tokens, ego: EgoVehicle) -> Iterator[str]:
    most = actor_model(ActorKind.VEHICLE, ego.model).max_speed
    for number, pose in enumerate(ego.reference_path):
        if pose.speed > most:
            yield placed(
                (*place, "reference_path", number, "speed"),
                f"{speed_words(pose.speed)}; {ego.model} reaches {speed_words(most)}; "
                f"{other_unit(pose.speed)}",
            )
            return


def _walker_note(place: Tokens, walker: NpcWalker) -> Iterator[str]:
    for number, point in enumerate(walker.route):
        if point.speed is not None and point.speed > FAST_WALKER:
            yield placed(
                (*place, "route", number, "speed"),
                f"walker {walker.id!r} moves at {speed_words(point.speed)}; people walk at about "
                f"1.4 m/s and run at up to {FAST_WALKER:g} m/s; {other_unit(point.speed)}",
            )
            return


def _acceleration_notes(place: Tokens, npc: NpcVehicle) -> Iterator[str]:
    model = actor_model(ActorKind.VEHICLE, npc.model)
    most = model.max_deceleration
    braking = npc.deceleration
    if braking is not None and braking > min(GRAVITY, HARD_BRAKING * most):
        yield placed(
            (*place, "deceleration"),
            f"{braking:g} m/s²; {npc.model} brakes with {most:g} m/s² at most, so that it "
            "uses no more",
        )
    side = npc.lateral_acceleration
    if side is not None and side > GRAVITY:
        yield placed(
            (*place, "lateral_acceleration"),
            f"{side:g} m/s²; a dry road allows {GRAVITY:g} m/s², and the vehicle uses less",
        )


def _limit_at(point: Waypoint, network: RoadNetwork) -> float | None:
    return limit_near(network, point.x, point.y)
