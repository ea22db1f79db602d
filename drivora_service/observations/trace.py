"""The trace of a run: arrays over (step, actor), read by oracles, feedback and metrics.

Frame: the network's plane, x east and y north in metres; angles in radians counter-clockwise from
east; positions are box centres. Row ``k`` is the state at time ``times[k]``; row 0 is the start.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import IntEnum, StrEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivora_service.geometry.array_shapes import BoolArray, ByteArray, FloatArray, Int32Array


class Role(StrEnum):
    """The role of an actor in the scenario."""

    EGO = "ego"
    NPC_VEHICLE = "npc_vehicle"
    NPC_WALKER = "npc_walker"
    NPC_OBSTACLE = "npc_obstacle"
    BACKGROUND = "background"


class Col(IntEnum):
    """Columns of ``Trace.states``."""

    X = 0
    Y = 1
    YAW = 2
    VX = 3
    VY = 4
    AX = 5
    AY = 6
    YAW_RATE = 7
    Z = 8
    """Height, metres; 0 on flat networks. Two actors more than ``LEVEL_GAP`` apart do not meet."""


class SizeCol(IntEnum):
    """Columns of arrays of actors' sizes, metres."""

    LENGTH = 0
    """Along the heading."""
    WIDTH = 1


LEVEL_GAP = 3.0
"""Metres; actors further apart in height are on different levels of a bridge."""


class EgoCol(IntEnum):
    """Columns of ``Trace.ego_values``.

    ``NaN`` is "not applicable at this step" (no light ahead, off all lanes).
    """

    ACCELERATION = 0
    """Commanded longitudinal acceleration, m/s²."""
    STEER = 1
    """Front-wheel angle applied, radians."""
    ROUTE_S = 2
    """Distance along the reference line of the route, metres."""
    ROUTE_LATERAL = 3
    """Signed distance from the reference line, metres, positive to the left."""
    SPEED_LIMIT = 4
    """Speed limit of the ego's lane, m/s."""
    LANE_LATERAL = 5
    """Signed distance from the centre of its lane, metres, positive to the left."""
    LANE_HEADING = 6
    """Heading of that lane at the foot point, radians."""
    LIGHT_DISTANCE = 7
    """Metres from the front bumper to the next signal's stop line on the route; negative once the
    bumper has passed it and the tail has not."""


class PoseCol(IntEnum):
    """Columns of ``Trace.references``."""

    TIME = 0
    """Simulation time, seconds; ascending."""
    X = 1
    Y = 2
    YAW = 3
    SPEED = 4
    Z = 5


class Light(IntEnum):
    """State of a signal."""

    NONE = 0
    GREEN = 1
    YELLOW = 2
    RED = 3


class TerminalEvent(StrEnum):
    """The event that ended an ego's part."""

    ARRIVED = "arrived"
    COLLISION = "collision"
    STUCK = "stuck"
    TIME_LIMIT = "time_limit"
    ROUTE_DEVIATION = "route_deviation"


@dataclass(frozen=True, slots=True, kw_only=True)
class Actor:
    """One row of a trace.

    Attributes:
        row: Index along the actor axis.
        length: Metres along the heading.
        width: Metres.
    """

    row: int
    id: str
    role: Role
    model: str
    length: float
    width: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Contact:
    """An overlap of two boxes; ``step`` is its first row of the trace."""

    step: int
    ego: int
    other: int


@dataclass(frozen=True, slots=True, kw_only=True)
class LogEvent:
    """A line of an agent's log."""

    step: int
    ego: int
    message: str


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PlannedPath:
    """The path that an agent planned at a step.

    Attributes:
        points: (n, 2) float32, metres.
    """

    step: int
    ego: int
    points: NDArray[np.float32]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class EgoRoute:
    """The route of an ego.

    Attributes:
        line: (n, 2) reference line, metres.
        arc: (n,) arc length of each point, metres.
        length: Metres from start to destination.
        goal: (x, y) of the destination, metres.
    """

    line: FloatArray
    arc: FloatArray
    length: float
    goal: tuple[float, float]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Trace:
    """A recorded run of T rows, N actors and M egos; egos are the first M actors.

    Attributes:
        network: Name of the road network.
        network_sha256: Hash of its file.
        scenario_sha256: Hash of the canonical scenario document.
        step_length: Seconds between rows.
        times: (T,) seconds.
        actors: N actors.
        states: (T, N, 9) float64, columns ``Col``; NaN where not present.
        present: (T, N) whether the actor was in the world.
        ego_values: (T, M, 8) float64, columns ``EgoCol``.
        ego_lanes: (T, M) index of the ego's lane, by its centre, -1 off all lanes.
        ego_lights: (T, M) ``Light`` of the signal that ``LIGHT_DISTANCE`` refers to.
        ego_routes: M routes.
        ego_start_times: M times in seconds.
        ego_ends: M terminal events.
        ego_end_steps: M rows at which each ego's part ended.
        contacts: First overlap of each (ego, other) pair, in order of time.
        light_ids: L traffic-light ids.
        light_states: (T, L) index into ``light_state_names``.
        light_state_names: SUMO state strings.
        log_names: K names of the agents' numeric log columns.
        log_values: (T, M, K) float64, NaN if an agent does not log the column.
        log_events: Text log lines.
        privileged: M flags of agents that bypassed the perception model.
        max_sim_time: Seconds.
        meta: Free JSON-able facts (versions, seed); not part of the hash.
        lane_ids: SUMO's ids of the lanes that occur in ``ego_lanes``, by index; may be empty; not
            part of the hash.
        plans: What agents told of their planned paths, in the order of steps; not part of the hash.
        references: For each ego, the (p, 6) path with which its own is compared, columns
            ``PoseCol``; with p = 0 if there is none. Empty if no ego has one. Part of the
            scenario, and so of its hash.
    """

    network: str
    network_sha256: str
    scenario_sha256: str
    step_length: float
    times: FloatArray
    actors: tuple[Actor, ...]
    states: FloatArray
    present: BoolArray
    ego_values: FloatArray
    ego_lanes: Int32Array
    ego_lights: ByteArray
    ego_routes: tuple[EgoRoute, ...]
    ego_start_times: tuple[float, ...]
    ego_ends: tuple[TerminalEvent, ...]
    ego_end_steps: tuple[int, ...]
    contacts: tuple[Contact, ...]
    light_ids: tuple[str, ...]
    light_states: Int32Array
    light_state_names: tuple[str, ...]
    log_names: tuple[str, ...]
    log_values: FloatArray
    log_events: tuple[LogEvent, ...]
    privileged: tuple[bool, ...]
    max_sim_time: float
    meta: dict[str, Any] = field(default_factory=dict)
    lane_ids: dict[int, str] = field(default_factory=dict)
    plans: tuple[PlannedPath, ...] = ()
    references: tuple[FloatArray, ...] = ()

    @property
    def ego_count(self) -> int:
        """Number M of egos."""
        return len(self.ego_routes)

    @property
    def step_count(self) -> int:
        """Number T of rows."""
        return len(self.times)

    def speeds(self, row: int) -> FloatArray:
        """Returns the (T,) speed over ground of the actor in ``row``, m/s."""
        return np.hypot(self.states[:, row, Col.VX], self.states[:, row, Col.VY])
