"""Values of an ego by step: what oracles and metrics judge, for plots."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drivora_service.errors import UnknownName
from drivora_service.geometry.array_shapes import FloatArray, Int32Array
from drivora_service.observations.leaders import leaders
from drivora_service.observations.own_frame import own_acceleration
from drivora_service.observations.proximity import gaps_between
from drivora_service.observations.recorded_conditions import frictions_under
from drivora_service.observations.run_view import EgoView
from drivora_service.observations.trace import EgoCol
from drivora_service.oracles.avoidability.careful_driver import GRAVITY
from drivora_service.scenario.models.actor_models import ActorKind, actor_model


@dataclass(frozen=True, slots=True, kw_only=True)
class SeriesColumn:
    """A value of an ego by step.

    Attributes:
        name: Name of the column.
        unit: "" for numbers without one.
        description: What it is, and when it is missing.
    """

    name: str
    unit: str
    description: str


COLUMNS = tuple(
    SeriesColumn(name=name, unit=unit, description=description)
    for name, unit, description in (
        ("step", "", "Row of the trace."),
        ("time", "s", "Simulation time."),
        ("speed", "m/s", "Speed over ground."),
        ("speed_limit", "m/s", "Limit of the ego's lane; missing off all lanes."),
        ("acceleration", "m/s²", "Along the heading, positive forwards."),
        ("lateral_acceleration", "m/s²", "Across the heading, positive to the left."),
        ("grip", "m/s²", "Greatest acceleration by friction there; missing if not recorded."),
        ("available_grip", "m/s²", "What the lateral acceleration leaves of it for braking."),
        ("commanded_acceleration", "m/s²", "What the agent asked for."),
        ("throttle", "", "Pedal that asks for it, 0 to 1; missing for unknown vehicles."),
        ("brake", "", "Pedal that asks for it, 0 to 1; missing for unknown vehicles."),
        ("steer", "rad", "Angle of the front wheels, positive to the left."),
        ("time_to_collision", "s", "At constant velocities; missing beyond 10 s."),
        ("time_to_collision_actor", "", "Row of that actor in the trace; -1: none."),
        ("forward_time_to_collision", "s", "The same with actors that are not behind."),
        ("gap", "m", "To the nearest actor, between the boxes; missing without others."),
        ("gap_actor", "", "Row of that actor in the trace; -1: none."),
        ("lead_gap", "m", "To the nearest actor in the strip ahead; missing without one."),
        ("lead_actor", "", "Row of that actor in the trace; -1: none."),
        ("lead_speed", "m/s", "Its speed along the ego's heading."),
        ("drac", "m/s²", "Braking that avoids the actor ahead at constant speeds; missing: none."),
        ("required_deceleration", "m/s²", "The same if that actor brakes on; missing: none."),
        ("lane", "", "Index of the ego's lane; -1 off all lanes."),
        ("lane_lateral", "m", "From the middle of the lane, positive to the left."),
        ("route_distance", "m", "Driven along the route."),
        ("route_left", "m", "Left of the route."),
        ("route_lateral", "m", "From the route's line, positive to the left."),
        ("light_distance", "m", "From the front to the next signal's stop line; missing: none."),
        ("light", "", "That signal: 0 none, 1 green, 2 yellow, 3 red."),
    )
)
"""The columns in order. ``drac`` and ``required_deceleration`` are 0 if no gap closes."""

INTEGERS = frozenset(
    {"step", "time_to_collision_actor", "gap_actor", "lead_actor", "lane", "light"}
)
"""Columns of whole numbers; all others are floats with NaN for missing values."""


def ego_series(ego: EgoView) -> Mapping[str, NDArray[np.generic]]:
    """Returns the (n,) values of an ego's part by the names of ``COLUMNS``."""
    near = ego.proximity if ego.count else None
    ahead = leaders(ego) if ego.count else None
    along, across = own_acceleration(ego.states)
    grip = frictions_under(ego.trace, ego.actor, ego.first, ego.states) * GRAVITY
    throttle, brake = _pedals(ego)
    gap, gap_actor = _nearest(ego)
    none = np.full(ego.count, np.nan)
    no_actor = np.full(ego.count, -1, dtype=np.int32)
    values: dict[str, NDArray[np.generic]] = {
        "step": np.arange(ego.first, ego.first + ego.count, dtype=np.int32),
        "time": ego.times,
        "speed": ego.speed,
        "speed_limit": ego.value(EgoCol.SPEED_LIMIT),
        "acceleration": along,
        "lateral_acceleration": across,
        "grip": grip,
        "available_grip": np.sqrt(np.maximum(grip**2 - across**2, 0.0)),
        "commanded_acceleration": ego.value(EgoCol.ACCELERATION),
        "throttle": throttle,
        "brake": brake,
        "steer": ego.value(EgoCol.STEER),
        "time_to_collision": none if near is None else _finite(near.time_to_collision),
        "time_to_collision_actor": no_actor if near is None else near.time_to_collision_actor,
        "forward_time_to_collision": (
            none if near is None else _finite(near.forward_time_to_collision)
        ),
        "gap": gap,
        "gap_actor": gap_actor,
        "lead_gap": none if ahead is None else _finite(ahead.room),
        "lead_actor": no_actor if ahead is None else ahead.actor,
        "lead_speed": none if ahead is None else ahead.speed,
        "drac": none if near is None else _finite(near.drac),
        "required_deceleration": none if near is None else _finite(near.required_deceleration),
        "lane": ego.lanes,
        "lane_lateral": ego.value(EgoCol.LANE_LATERAL),
        "route_distance": ego.value(EgoCol.ROUTE_S),
        "route_left": ego.route.length - ego.value(EgoCol.ROUTE_S),
        "route_lateral": ego.value(EgoCol.ROUTE_LATERAL),
        "light_distance": ego.value(EgoCol.LIGHT_DISTANCE),
        "light": ego.lights,
    }
    return {column.name: values[column.name] for column in COLUMNS}


def _nearest(ego: EgoView) -> tuple[FloatArray, Int32Array]:
    """Returns the (n,) gap to the nearest actor, metres, and that actor; NaN and -1 without one."""
    part = slice(ego.first, ego.first + ego.count)
    others = [actor.row for actor in ego.trace.actors if actor.row != ego.row]
    if not others or not ego.count:
        return np.full(ego.count, np.nan), np.full(ego.count, -1, dtype=np.int32)
    gaps = np.stack([gaps_between(ego.trace, ego.row, row)[part] for row in others])
    gaps[np.isnan(gaps)] = np.inf
    nearest = np.argmin(gaps, axis=0)
    least = gaps[nearest, np.arange(ego.count)]
    actors = np.array(others, dtype=np.int32)[nearest]
    return _finite(least), np.where(np.isfinite(least), actors, -1).astype(np.int32)


def _pedals(ego: EgoView) -> tuple[FloatArray, FloatArray]:
    """Returns the (n,) throttle and brake for the commanded acceleration; NaN if not known.

    Pedals ask for shares of the vehicle's greatest acceleration and braking, in
    ``simulation.motion.vehicle_commands``, so that they follow from the acceleration.
    """
    asked = ego.value(EgoCol.ACCELERATION)
    try:
        model = actor_model(ActorKind.VEHICLE, ego.actor.model)
    except UnknownName:
        return np.full(ego.count, np.nan), np.full(ego.count, np.nan)
    return (
        np.clip(asked / model.max_acceleration, 0.0, 1.0),
        np.clip(-asked / model.max_deceleration, 0.0, 1.0),
    )


def _finite(values: FloatArray) -> FloatArray:
    """Returns values with NaN for what is infinite."""
    return np.where(np.isfinite(values), values, np.nan)
