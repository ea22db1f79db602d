"""What an ADS in a process of its own is told, as plain values and NumPy arrays.

In place of the road network there are the lanes around the route, so that nothing of Drivora's own
representation has to be understood, or loaded, on the other side.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

from drivora_service.agents.interface import Control, Observation
from drivora_service.agents.log import AgentLog
from drivora_service.geometry.arrays import FloatArray, IntArray


@dataclass(frozen=True, slots=True, kw_only=True)
class VehicleView:
    """Size and limits of the vehicle to drive; SI units.

    Attributes:
        max_deceleration: m/s², positive.
        max_steer: Radians at the front wheels.
    """

    model: str
    length: float
    width: float
    wheelbase: float
    mass: float
    max_acceleration: float
    max_deceleration: float
    max_steer: float
    max_speed: float


@dataclass(frozen=True, slots=True, kw_only=True)
class SignalView:
    """A signal on the route.

    Attributes:
        s: Distance of the stop line along the route, metres.
        lane: Id of the lane at whose end it stands.
    """

    s: float
    lane: int


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RouteView:
    """The way to drive, as a line with points at most 1 m apart.

    Attributes:
        line: (n, 2) metres.
        arc: (n,) metres from the start; ``arc[-1]`` is the length.
        speed_limits: (n,) m/s.
        widths: (n,) of the lane at each point, metres.
        lanes: (n,) id of the lane at each point.
        signals: In order along the route.
        runs: Ids of lanes that follow one another; between two runs the vehicle changes lanes.
    """

    line: FloatArray
    arc: FloatArray
    speed_limits: FloatArray
    widths: FloatArray
    lanes: IntArray
    signals: tuple[SignalView, ...]
    runs: tuple[tuple[int, ...], ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LaneView:
    """A drivable lane.

    Attributes:
        line: (n, 2) centre line in the direction of travel, metres.
        width: Metres.
        speed_limit: m/s.
        successors: Ids of the lanes behind its end; some may not be among the lanes at hand.
        left: Id of the neighbour in the same direction, or ``None``.
        right: The same to the right.
        may_change_left: Whether one may change there.
        may_change_right: The same to the right.
        in_junction: Whether it lies inside a junction.
    """

    id: int
    line: FloatArray
    width: float
    speed_limit: float
    successors: tuple[int, ...]
    left: int | None
    right: int | None
    may_change_left: bool
    may_change_right: bool
    in_junction: bool


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ContextView:
    """What is known before the first step.

    Attributes:
        lanes: The drivable lanes around the route, by id.
        step_length: Seconds between two steps.
        friction: Tyre-road friction coefficient, 0..1.
        seed: For every random draw.
        parameters: From the document.
        log: Where to write what the ADS thinks; declare its columns in ``setup_env``.
    """

    ego_id: str
    vehicle: VehicleView
    route: RouteView
    lanes: Mapping[int, LaneView]
    step_length: float
    friction: float
    seed: int
    parameters: Mapping[str, Any]
    log: AgentLog


class Adapter(Protocol):
    """An ADS behind the protocol; the same two calls as in process."""

    def setup_env(self, context: ContextView) -> None:
        """Prepares for a run; called before the first step of every run."""
        ...

    def run_step(self, observation: Observation) -> Control:
        """Decides what to do until the next step."""
        ...
