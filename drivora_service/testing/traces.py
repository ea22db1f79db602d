"""Synthetic traces: the ``Trace`` of a run, made from the given motion of its actors.

For tests of oracles, metrics and feedbacks on runs with a known answer.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.geometry.lines import arc_lengths
from drivora_service.observations.trace import (
    Actor,
    Col,
    Contact,
    EgoCol,
    EgoRoute,
    Light,
    LogEvent,
    Role,
    TerminalEvent,
    Trace,
)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Motion:
    """The motion of an actor by step.

    Attributes:
        states: (T, 9) columns ``Col``.
    """

    states: FloatArray

    @staticmethod
    def along(
        x: ArrayLike, y: ArrayLike, *, step_length: float = 0.05, yaw: ArrayLike | None = None
    ) -> Motion:
        """Returns the motion through positions (T,) in metres; the rest follows by differences.

        Args:
            x: Metres, one value for each step.
            y: Metres, one value for each step.
            step_length: Seconds between them.
            yaw: Radians; by default the direction of motion, 0 at standstill.
        """
        xs, ys = np.broadcast_arrays(np.asarray(x, float), np.asarray(y, float))
        states = np.zeros((len(xs), len(Col)))
        states[:, Col.X], states[:, Col.Y] = xs, ys
        if len(xs) > 1:
            states[:, Col.VX] = np.gradient(xs, step_length)
            states[:, Col.VY] = np.gradient(ys, step_length)
            states[:, Col.AX] = np.gradient(states[:, Col.VX], step_length)
            states[:, Col.AY] = np.gradient(states[:, Col.VY], step_length)
        if yaw is None:
            moving = np.hypot(states[:, Col.VX], states[:, Col.VY]) > 1e-9
            heading = np.arctan2(states[:, Col.VY], states[:, Col.VX])
            states[:, Col.YAW] = np.where(moving, heading, 0.0)
        else:
            states[:, Col.YAW] = yaw
        if len(xs) > 1:
            states[:, Col.YAW_RATE] = np.gradient(np.unwrap(states[:, Col.YAW]), step_length)
        return Motion(states=states)

    @staticmethod
    def steady(
        x: float,
        y: float,
        *,
        steps: int,
        speed: float = 0.0,
        yaw: float = 0.0,
        step_length: float = 0.05,
    ) -> Motion:
        """Returns the motion from (x, y) metres straight along ``yaw`` radians at ``speed`` m/s."""
        distance = speed * step_length * np.arange(steps)
        states = np.zeros((steps, len(Col)))
        states[:, Col.X] = x + distance * np.cos(yaw)
        states[:, Col.Y] = y + distance * np.sin(yaw)
        states[:, Col.YAW] = yaw
        states[:, Col.VX] = speed * np.cos(yaw)
        states[:, Col.VY] = speed * np.sin(yaw)
        return Motion(states=states)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SyntheticEgo:
    """An ego of a synthetic trace. Per-step values are a number for all steps or (T,) arrays.

    Attributes:
        route: (n, 2) reference line in metres; ``None``: the straight line that it drove.
        route_s: Metres; ``None``: the distance driven.
        end_step: Row at which its part ended; ``None``: the last.
    """

    motion: Motion
    id: str = "ego"
    length: float = 4.5
    width: float = 1.8
    route: FloatArray | None = None
    route_s: ArrayLike | None = None
    route_lateral: ArrayLike = 0.0
    acceleration: ArrayLike = 0.0
    steer: ArrayLike = 0.0
    speed_limit: ArrayLike = np.nan
    lane: ArrayLike = -1
    lane_lateral: ArrayLike = np.nan
    lane_heading: ArrayLike = np.nan
    light: ArrayLike = Light.NONE
    light_distance: ArrayLike = np.nan
    start_time: float = 0.0
    end: TerminalEvent = TerminalEvent.TIME_LIMIT
    end_step: int | None = None
    logs: Mapping[str, ArrayLike] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SyntheticActor:
    """Another actor of a synthetic trace; ``present`` is (T,) flags, ``None`` for always."""

    motion: Motion
    id: str = "npc"
    role: Role = Role.NPC_VEHICLE
    length: float = 4.5
    width: float = 1.8
    present: ArrayLike | None = None


def make_trace(
    egos: Sequence[SyntheticEgo],
    others: Sequence[SyntheticActor] = (),
    *,
    step_length: float = 0.05,
    contacts: Sequence[Contact] = (),
    lights: Mapping[str, Sequence[str]] | None = None,
    log_events: Sequence[LogEvent] = (),
    max_sim_time: float = 120.0,
) -> Trace:
    """Builds a trace; every motion has the same number of steps.

    Args:
        egos: At least one ego.
        others: Other actors.
        step_length: Seconds.
        contacts: Contacts as a run would record them.
        lights: SUMO's state string at each step by traffic-light id.
        log_events: Lines of the agents' logs.
        max_sim_time: Seconds.
    """
    steps = len(egos[0].motion.states)
    all_actors: list[SyntheticEgo | SyntheticActor] = [*egos, *others]
    present = np.ones((steps, len(all_actors)), dtype=np.bool_)
    for row, actor in enumerate(others, start=len(egos)):
        if actor.present is not None:
            present[:, row] = actor.present
    states = np.stack([actor.motion.states for actor in all_actors], axis=1)
    states[~present] = np.nan

    values = np.full((steps, len(egos), len(EgoCol)), np.nan)
    lanes = np.full((steps, len(egos)), -1, dtype=np.int32)
    ego_lights = np.zeros((steps, len(egos)), dtype=np.uint8)
    log_names = tuple(sorted({name for ego in egos for name in ego.logs}))
    logs = np.full((steps, len(egos), len(log_names)), np.nan)
    routes = []
    for row, ego in enumerate(egos):
        path = ego.motion.states[:, [Col.X, Col.Y]]
        values[:, row, EgoCol.ACCELERATION] = ego.acceleration
        values[:, row, EgoCol.STEER] = ego.steer
        values[:, row, EgoCol.ROUTE_S] = arc_lengths(path) if ego.route_s is None else ego.route_s
        values[:, row, EgoCol.ROUTE_LATERAL] = ego.route_lateral
        values[:, row, EgoCol.SPEED_LIMIT] = ego.speed_limit
        values[:, row, EgoCol.LANE_LATERAL] = ego.lane_lateral
        values[:, row, EgoCol.LANE_HEADING] = ego.lane_heading
        values[:, row, EgoCol.LIGHT_DISTANCE] = ego.light_distance
        lanes[:, row] = ego.lane
        ego_lights[:, row] = ego.light
        for name, column in ego.logs.items():
            logs[:, row, log_names.index(name)] = column
        line = path[[0, -1]] if ego.route is None else np.asarray(ego.route, dtype=np.float64)
        arc = arc_lengths(line)
        goal = (float(line[-1, 0]), float(line[-1, 1]))
        routes.append(EgoRoute(line=line, arc=arc, length=float(arc[-1]), goal=goal))

    light_columns = dict(lights or {})
    names = tuple(sorted({state for shown in light_columns.values() for state in shown}))
    light_states = np.zeros((steps, len(light_columns)), dtype=np.int32)
    for column, shown in enumerate(light_columns.values()):
        light_states[:, column] = [names.index(state) for state in shown]
    return Trace(
        network="synthetic",
        network_sha256="0" * 64,
        scenario_sha256="1" * 64,
        step_length=step_length,
        times=np.arange(steps) * np.float64(step_length),
        actors=tuple(
            Actor(
                row=row,
                id=actor.id,
                role=actor.role if isinstance(actor, SyntheticActor) else Role.EGO,
                model="synthetic",
                length=actor.length,
                width=actor.width,
            )
            for row, actor in enumerate(all_actors)
        ),
        states=states,
        present=present,
        ego_values=values,
        ego_lanes=lanes,
        ego_lights=ego_lights,
        ego_routes=tuple(routes),
        ego_start_times=tuple(ego.start_time for ego in egos),
        ego_ends=tuple(ego.end for ego in egos),
        ego_end_steps=tuple(steps - 1 if ego.end_step is None else ego.end_step for ego in egos),
        contacts=tuple(contacts),
        light_ids=tuple(light_columns),
        light_states=light_states,
        light_state_names=names,
        log_names=log_names,
        log_values=logs,
        log_events=tuple(log_events),
        privileged=(False,) * len(egos),
        max_sim_time=max_sim_time,
    )


def with_contact(trace: Trace, *, step: int, ego: int, other: int) -> Trace:
    """Returns the trace with one more contact, as a run would record it."""
    contact = Contact(step=step, ego=ego, other=other)
    return replace(trace, contacts=(*trace.contacts, contact))
