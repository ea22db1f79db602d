"""Context of an ADS with its own process, as plain values and NumPy arrays.

The lanes around the route replace the road network, so that Drivora's own
representation need not be understood or loaded on the other side.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

from drivora_service.agents.interface import Control, Observation
from drivora_service.agents.log import AgentLog
from drivora_service.agents.raster.raster_settings import Raster, RasterSettings
from drivora_service.agents.remote.requested_rasters import RequestedRasters
from drivora_service.geometry.array_shapes import FloatArray, IntArray


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
        lane: Id of the lane that it controls.
    """

    s: float
    lane: int


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RouteView:
    """The route, as a line with points at most 1 m apart.

    Attributes:
        line: (n, 2) metres.
        arc: (n,) metres from the start; ``arc[-1]`` is the length.
        speed_limits: (n,) m/s.
        widths: (n,) of the lane at each point, metres.
        lanes: (n,) id of the lane at each point.
        signals: Signals in order along the route.
        runs: Ids of consecutive lanes; between two runs the vehicle changes lanes.
        stop_signs: (k,) distance along the route of the stop lines at which it must stop first (a
            stop sign, an all-way stop), metres.
    """

    line: FloatArray
    arc: FloatArray
    speed_limits: FloatArray
    widths: FloatArray
    lanes: IntArray
    signals: tuple[SignalView, ...]
    runs: tuple[tuple[int, ...], ...]
    stop_signs: FloatArray = field(default_factory=lambda: np.empty(0))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LaneView:
    """A drivable lane.

    Attributes:
        line: (n, 2) centre line in the direction of travel, metres.
        width: Metres.
        speed_limit: m/s.
        successors: Ids of the next lanes; some may not be among the known lanes.
        left: Id of the neighbour in the same direction, or ``None``.
        right: Id of the neighbour to the right, likewise.
        may_change_left: Whether a change to it is allowed.
        may_change_right: Likewise to the right.
        in_junction: Whether it is inside a junction.
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
    """The context of a run, before the first step.

    Attributes:
        lanes: The drivable lanes around the route, by id.
        step_length: Seconds between two steps.
        friction: Tyre-road friction coefficient, 0..1.
        seed: Seed for all random draws.
        parameters: Parameters from the document.
        log: Log of the ADS, whose columns are declared in ``setup_env``.
        rasters: Images that the ADS requests by :meth:`raster`.
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
    rasters: RequestedRasters = field(default_factory=RequestedRasters, repr=False)

    def raster(self, settings: RasterSettings | None = None) -> Raster:
        """Returns bird's-eye images of this run, drawn by Drivora; call it in ``setup_env``.

        Args:
            settings: As of ``AgentContext.raster``.

        Raises:
            AgentError: The call comes after ``setup_env``, there are too many, or this version of
                Drivora cannot draw them.
        """
        return self.rasters.request(settings or RasterSettings())


class Adapter(Protocol):
    """An ADS behind the protocol; the same two calls as in process."""

    def setup_env(self, context: ContextView) -> None:
        """Sets up a run; called before the first step of every run."""
        ...

    def run_step(self, observation: Observation) -> Control:
        """Returns the control until the next step."""
        ...
