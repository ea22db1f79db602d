"""The interface to libsumo, which is used in this module only.

A process holds one SUMO at a time, so it has one open world. ``SumoWorld.open`` resets with
``load``, which is bit-identical to a fresh process; ``loadState`` is not.

SUMO's positions are front bumpers and its angles degrees clockwise from north; everything outside
this file has box centres and radians counter-clockwise from east.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from drivora_service.errors import SimulatorError
from drivora_service.geometry.angles import wrap_angle
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.networks.road_network import SignalPhase
from drivora_service.observations.trace import Col
from drivora_service.simulation.motion.vehicle_dynamics import GRAVITY
from drivora_service.simulation.plans.light_programs import RunningProgram
from drivora_service.simulation.sumo_modes import (
    CHANGES_LANES,
    KEEPS_LANE,
    NO_SPEED_LIMITS,
    OBEYS_ALL,
    Placing,
)
from drivora_service.system_libraries import explain

try:
    import libsumo
except ImportError as error:
    raise SimulatorError(explain(error)) from error


SUMO_ERRORS = (libsumo.TraCIException, libsumo.FatalTraCIError)
"""The errors of libsumo."""

_DRIVER_TYPES = Path(__file__).with_name("driver_types.add.xml")
_ON_ROUTE, _ANYWHERE = int(Placing.ON_ROUTE), int(Placing.ANYWHERE)
_MOVED_TYPE = "DEFAULT_VEHTYPE"
_ITS_OWN_SPEED = -1.0
"""Ends the setting of a vehicle's speed."""
_REACH = 3.0
"""Metres within which SUMO looks for a lane: the time of a placement grows with it."""
_NO_REACH = -1.0
"""Reach with which SUMO finds no lane, not even under the pose."""
_FREE_STEPS = 2
"""Steps for which a vehicle that is new on the lanes is placed freely: mapping onto its route, and
holding it, work only once it is on the road."""
_RETRY_AFTER = 40
"""Steps after which placing on the route is tried again for a vehicle off it."""
_ARRIVAL_ZONE = 1.0
"""Metres before the end of its route in which SUMO may count a standing vehicle as arrived."""
_PROGRAM = "drivora"
"""Name of the service's programmes for traffic lights."""
_IMPATIENT_AFTER = "30"
_SUBLANE_WIDTH = "0.8"
"""Metres: the middle of the range that SUMO's documentation names for cars."""
_STANDING_SPEED = 0.1
"""m/s below which a vehicle stands."""


@dataclass(slots=True, eq=False)
class MovedActor:
    """A vehicle in SUMO that the service moves.

    Attributes:
        row: Its row in the world's arrays.
        half_length: Metres from the centre to the front bumper.
        width: Metres.
        is_walker: Whether it is a walker.
        follows_route: Whether it is expected on its route, where placing it is cheapest.
        retry_in: Steps until the route is tried again.
        stands: Whether SUMO holds it at its pose without a placement in each step.
        held: Whether SUMO holds it far behind its pose, where that makes no difference.
        off_lanes: Whether it is on no lane in SUMO for any pose: its stand-ins are instead.
        watched: Whether it is checked while it moves, too.
        lifted: Whether it is on no lane for the next step, and then comes onto its lane anew.
    """

    row: int
    id: str
    half_length: float
    width: float
    is_walker: bool
    follows_route: bool
    retry_in: int = 0
    stands: bool = False
    off_lanes: bool = False
    watched: bool = False
    held: bool = False
    lifted: bool = False

    @property
    def is_on_lane(self) -> bool:
        """Whether SUMO has it on the lane of its pose."""
        return not (self.off_lanes or self.held or self.lifted)

    @property
    def keeps_to_route(self) -> bool:
        """Whether it has been placed on its route, and drives."""
        return (
            self.follows_route
            and self.retry_in <= 0
            and not (self.stands or self.off_lanes or self.watched)
        )


@dataclass(slots=True, eq=False)
class DrivenActor:
    """A vehicle that SUMO drives.

    Attributes:
        row: Its row in the world's arrays.
        half_length: Metres from the centre to the front bumper.
        width: Metres.
    """

    row: int
    id: str
    half_length: float
    width: float


class SumoWorld:
    """The simulation in SUMO. Opening one ends the one before."""

    def __init__(
        self,
        network: Path,
        *,
        step_length: float,
        seed: int,
        slippery: bool,
        sublanes: bool = False,
    ) -> None:
        """Describes a world; nothing of it is loaded before ``open``.

        Args:
            network: The ``.net.xml`` file.
            step_length: Seconds.
            seed: Of SUMO's own random draws.
            slippery: Whether SUMO's drivers react to the friction of the road (the device costs
                time).
            sublanes: Whether vehicles have positions within lanes. Then SUMO accepts only drivers
                with the lane-change model SL2015; without, it would silently drive them by LC2013.
        """
        self._network = network
        self._arguments = (
            "--net-file", str(network),
            "--additional-files", str(_DRIVER_TYPES),
            "--step-length", repr(step_length),
            "--seed", str(seed % 2**31),
            "--no-warnings", "true",
            "--no-step-log", "true",
            "--collision.action", "none",
            "--time-to-teleport", "-1",
            # Drivers on minor roads grow impatient, else full junctions lock up permanently.
            "--time-to-impatience", _IMPATIENT_AFTER,
            "--device.friction.probability", "1" if slippery else "0",
            *(("--lateral-resolution", _SUBLANE_WIDTH) if sublanes else ()),
        )  # fmt: skip
        self._types: set[str] = set()
        self._routes = 0
        self._grip = math.inf
        self._own_limits: dict[str, tuple[float, float, float]] = {}

    def open(self) -> None:
        """Resets this process's SUMO to the empty network at time 0.

        Raises:
            SimulatorError: If SUMO does not accept the network.
        """
        try:
            if _process.started:
                libsumo.load(list(self._arguments))
            else:
                libsumo.start(["sumo", *self._arguments])
                _process.started = True
        except SUMO_ERRORS as error:
            _process.started = False
            raise SimulatorError(
                f"SUMO does not start with {self._network.name}: {error}"
            ) from error

    def set_programs(self, programs: Sequence[RunningProgram], time: float) -> None:
        """Sets the fixed-time programme of every traffic light from ``time`` seconds on."""
        for program in programs:
            libsumo.trafficlight.setProgramLogic(program.id, _logic(program.phases))
            libsumo.trafficlight.setProgram(program.id, _PROGRAM)
            phase, left = program.stage_at(time)
            libsumo.trafficlight.setPhase(program.id, phase)
            libsumo.trafficlight.setPhaseDuration(program.id, left)

    def light_state(self, light_id: str) -> str:
        """Returns the signals that SUMO shows now, one letter a link."""
        return str(libsumo.trafficlight.getRedYellowGreenState(light_id))

    def set_friction(self, edges: Sequence[str], friction: float) -> None:
        """Sets the friction coefficient that SUMO's drivers find on the given edges.

        In SUMO it only makes them drive more slowly: their braking is limited here.
        """
        self._grip = friction * GRAVITY
        for edge in edges:
            libsumo.edge.setFriction(edge, friction)

    def limit_grip(self, actor_id: str, grip: float) -> None:
        """Limits acceleration and braking of a vehicle that SUMO drives to a grip, m/s².

        A later limit replaces it; a grip of more than the vehicle uses gives it back its own.
        """
        own = self._own_limits.get(actor_id)
        if own is None:
            own = self._own_limits[actor_id] = (
                libsumo.vehicle.getAccel(actor_id),
                libsumo.vehicle.getDecel(actor_id),
                libsumo.vehicle.getEmergencyDecel(actor_id),
            )
        acceleration, deceleration, emergency = (min(limit, grip) for limit in own)
        libsumo.vehicle.setAccel(actor_id, acceleration)
        # SUMO does not accept an emergency braking below the usual one, not even in between.
        libsumo.vehicle.setEmergencyDecel(actor_id, max(own[2], deceleration))
        libsumo.vehicle.setDecel(actor_id, deceleration)
        libsumo.vehicle.setEmergencyDecel(actor_id, emergency)

    def add_moved(
        self,
        row: int,
        actor_id: str,
        edges: Sequence[str],
        *,
        length: float,
        width: float,
        is_walker: bool,
        follows_route: bool,
    ) -> MovedActor:
        """Adds a vehicle that will be placed every step; the first placement inserts it."""
        vehicle_type = self._ensure_type(_MOVED_TYPE, length, width, is_walker)
        self._add(actor_id, edges, vehicle_type)
        libsumo.vehicle.setSpeedMode(actor_id, NO_SPEED_LIMITS)
        libsumo.vehicle.setLaneChangeMode(actor_id, KEEPS_LANE)
        return MovedActor(
            row, actor_id, 0.5 * length, width, is_walker, follows_route, retry_in=_FREE_STEPS
        )

    def add_stand_in(
        self, stand_in_id: str, edges: Sequence[str], *, length: float, width: float
    ) -> None:
        """Adds a vehicle that stands on a lane; ``move_stand_in`` puts it there.

        Args:
            stand_in_id: A new id.
            edges: Only the edge of the lane, so that it approaches no junction, or the edges
                before and behind an internal lane.
            length: Metres.
            width: Metres.
        """
        self._add(stand_in_id, edges, self._ensure_type(_MOVED_TYPE, length, width, False))
        libsumo.vehicle.setSpeedMode(stand_in_id, NO_SPEED_LIMITS)
        libsumo.vehicle.setLaneChangeMode(stand_in_id, KEEPS_LANE)
        libsumo.vehicle.setSpeed(stand_in_id, 0.0)

    def move_stand_in(self, stand_in_id: str, lane: str, position: float) -> None:
        """Puts a stand-in with its front bumper at ``position`` metres of a lane on its route."""
        libsumo.vehicle.moveTo(stand_in_id, lane, position)

    def lane_of(self, actor_id: str) -> str:
        """Returns the id of the lane that SUMO has a vehicle on; "" where it is on none."""
        return str(libsumo.vehicle.getLaneID(actor_id))

    def add_driven(
        self,
        row: int,
        actor_id: str,
        edges: Sequence[str],
        *,
        driver: str,
        length: float,
        width: float,
        lane_number: int,
        position: float,
        arrival: float | None,
        has_speed: bool = False,
    ) -> DrivenActor:
        """Adds a vehicle that SUMO drives, with its front bumper at ``position`` metres.

        It leaves with its front bumper at ``arrival`` metres of its last lane; ``None`` is the end
        of that lane. SUMO chooses a speed that is safe there; any other may be refused. It is that
        of the last vehicle on the lane, or the greatest one if there is none. ``has_speed``: the
        vehicle has a speed to begin with, to which it can be slowed down, so that it gets the
        greatest one, too, where that last vehicle stands: it may do so far ahead.
        """
        vehicle_type = self._ensure_type(driver, length, width, is_walker=False)
        self._add(
            actor_id,
            edges,
            vehicle_type,
            departLane=str(lane_number),
            departPos=f"{position:.3f}",
            arrivalPos="max" if arrival is None else f"{arrival:.3f}",
            departSpeed="max" if has_speed and self._last_stands(edges[0], lane_number) else "last",
        )
        return DrivenActor(row, actor_id, 0.5 * length, width)

    def _last_stands(self, edge: str, lane_number: int) -> bool:
        """Returns whether the last vehicle on a lane stands, however far ahead."""
        vehicles = libsumo.lane.getLastStepVehicleIDs(f"{edge}_{lane_number}")
        return bool(vehicles) and libsumo.vehicle.getSpeed(vehicles[0]) < _STANDING_SPEED

    def _add(self, actor_id: str, edges: Sequence[str], vehicle_type: str, **depart: str) -> None:
        route = f"route:{self._routes}"
        self._routes += 1
        try:
            libsumo.route.add(route, list(edges))
            libsumo.vehicle.add(actor_id, route, vehicle_type, **depart)
        except libsumo.TraCIException as error:
            raise SimulatorError(f"SUMO rejects {actor_id!r}: {error}") from error

    def _ensure_type(self, base: str, length: float, width: float, is_walker: bool) -> str:
        name = f"{base}:{length:.3f}x{width:.3f}{':walker' if is_walker else ''}"
        if name not in self._types:
            libsumo.vehicletype.copy(base, name)
            libsumo.vehicletype.setLength(name, length)
            libsumo.vehicletype.setWidth(name, width)
            # A speed factor for each vehicle would be drawn from the shared random stream.
            if base == _MOVED_TYPE:
                libsumo.vehicletype.setSpeedDeviation(name, 0.0)
            libsumo.vehicletype.setDecel(name, min(libsumo.vehicletype.getDecel(name), self._grip))
            emergency = min(libsumo.vehicletype.getEmergencyDecel(name), self._grip)
            libsumo.vehicletype.setEmergencyDecel(name, emergency)
            if is_walker:
                libsumo.vehicletype.setShapeClass(name, "pedestrian")
            self._types.add(name)
        return name

    def set_speed_now(self, actor_id: str, speed: float) -> None:
        """Sets a vehicle's speed at the beginning of the next step, m/s."""
        libsumo.vehicle.setPreviousSpeed(actor_id, speed)

    def hand_over(self, actor: MovedActor, speed: float, driver: str) -> DrivenActor:
        """Lets SUMO drive a vehicle that was moved until now, from ``speed`` m/s on."""
        driven = self._ensure_type(driver, 2.0 * actor.half_length, actor.width, is_walker=False)
        libsumo.vehicle.setType(actor.id, driven)
        libsumo.vehicle.setSpeed(actor.id, _ITS_OWN_SPEED)
        libsumo.vehicle.setPreviousSpeed(actor.id, speed)
        libsumo.vehicle.setSpeedMode(actor.id, OBEYS_ALL)
        libsumo.vehicle.setLaneChangeMode(actor.id, CHANGES_LANES)
        return DrivenActor(actor.row, actor.id, actor.half_length, actor.width)

    def take_back(self, actor: DrivenActor) -> MovedActor:
        """Moves a vehicle again that SUMO drove until now.

        It is placed by force once, since it may be in the middle of a lane change.
        """
        libsumo.vehicle.setSpeedMode(actor.id, NO_SPEED_LIMITS)
        libsumo.vehicle.setLaneChangeMode(actor.id, KEEPS_LANE)
        return MovedActor(
            actor.row, actor.id, actor.half_length, actor.width, False, False, retry_in=1
        )

    def is_out_of_order(self, actor_id: str) -> bool:
        """Returns whether a vehicle is at a wrong place in SUMO's list of its lane's vehicles."""
        lane = libsumo.vehicle.getLaneID(actor_id)
        ids = libsumo.lane.getLastStepVehicleIDs(lane) if lane else ()
        if actor_id not in ids:
            return False
        places = [libsumo.vehicle.getLanePosition(one) for one in ids]
        own = ids.index(actor_id)
        return any(place > places[own] for place in places[:own]) or any(
            place < places[own] for place in places[own + 1 :]
        )

    def place(self, actors: Sequence[MovedActor], placements: Sequence[Sequence[float]]) -> None:
        """Puts moved actors at their poses for the next step.

        Args:
            actors: Actors to be placed.
            placements: For every row of the world, columns ``step_kernels.PlacementCol``.
        """
        move = libsumo.vehicle.moveToXY
        for actor in actors:
            x, y, angle, moved = placements[actor.row]
            if moved < 0.0:
                if actor.held:
                    continue
                if actor.keeps_to_route:
                    libsumo.vehicle.setSpeed(actor.id, 0.0)
                    actor.held = True
                    continue
            elif actor.held:
                libsumo.vehicle.setSpeed(actor.id, _ITS_OWN_SPEED)
                actor.held = False
                moved = 1.0
            if actor.off_lanes or actor.lifted:
                actor.stands = actor.lifted = False
                actor.retry_in = _FREE_STEPS
                move(actor.id, "", -1, x, y, angle, _ANYWHERE, _NO_REACH)
                continue
            if moved == 0.0:
                if not actor.stands and actor.retry_in <= 0 and not _at_route_end(actor.id):
                    libsumo.vehicle.setSpeed(actor.id, 0.0)
                    actor.stands = True
                if actor.stands:
                    continue
            elif actor.stands:
                libsumo.vehicle.setSpeed(actor.id, _ITS_OWN_SPEED)
                actor.stands = False
            if actor.follows_route and actor.retry_in <= 0:
                try:
                    move(actor.id, "", -1, x, y, angle, _ON_ROUTE, _REACH)
                except libsumo.TraCIException:
                    actor.retry_in = _RETRY_AFTER
                    move(actor.id, "", -1, x, y, angle, _ANYWHERE, _REACH)
            else:
                actor.retry_in -= 1
                move(actor.id, "", -1, x, y, angle, _ANYWHERE, _REACH)

    def step(self) -> None:
        """Lets SUMO simulate one step.

        Raises:
            SimulatorError: If SUMO refuses to.
        """
        try:
            libsumo.simulationStep()
        except SUMO_ERRORS as error:
            raise SimulatorError(f"SUMO cannot continue: {error}") from error

    def read_driven(
        self, actors: Sequence[DrivenActor], states: FloatArray, present: NDArray[np.bool_]
    ) -> None:
        """Writes pose and speed of vehicles that SUMO drives into the world's arrays.

        A vehicle that is not on the road becomes absent.
        """
        # Three calls a vehicle cost less than a subscription, and less than to read its results.
        position_of, angle_of = libsumo.vehicle.getPosition3D, libsumo.vehicle.getAngle
        speed_of = libsumo.vehicle.getSpeed
        for actor in actors:
            name, row = actor.id, actor.row
            try:
                position = position_of(name)
            except libsumo.TraCIException:
                # It has left the road.
                present[row] = False
                continue
            if position[0] < -1e6:
                # It waits to enter.
                present[row] = False
                continue
            front_x, front_y, height = position
            yaw = wrap_angle(math.radians(90.0 - angle_of(name)))
            cos, sin = math.cos(yaw), math.sin(yaw)
            v = speed_of(name)
            state = states[row]
            state[Col.X] = front_x - actor.half_length * cos
            state[Col.Y] = front_y - actor.half_length * sin
            state[Col.YAW] = yaw
            state[Col.VX] = v * cos
            state[Col.VY] = v * sin
            state[Col.Z] = height
            present[row] = True

    def count_remaining_edges(self, actor_id: str) -> int:
        """Returns the number of edges ahead on a vehicle's route."""
        route = libsumo.vehicle.getRoute(actor_id)
        return len(route) - 1 - int(libsumo.vehicle.getRouteIndex(actor_id))

    def extend_route(self, actor_id: str, more: Sequence[str]) -> None:
        """Appends edges to a vehicle's route."""
        route = libsumo.vehicle.getRoute(actor_id)
        index = max(int(libsumo.vehicle.getRouteIndex(actor_id)), 0)
        libsumo.vehicle.setRoute(actor_id, [*route[index:], *more])

    def last_edge(self, actor_id: str) -> str:
        """Returns the last edge of a vehicle's route."""
        return str(libsumo.vehicle.getRoute(actor_id)[-1])

    def known_ids(self) -> frozenset[str]:
        """Returns the ids of the vehicles that are on the road or wait to enter it."""
        return frozenset(libsumo.vehicle.getLoadedIDList())

    def remove(self, actor_id: str) -> None:
        """Removes a vehicle, if it is still known."""
        try:
            libsumo.vehicle.remove(actor_id)
        except libsumo.TraCIException:
            # It left the road by itself in this step.
            return


def _at_route_end(actor_id: str) -> bool:
    """Returns whether SUMO would remove a vehicle that stands there as arrived."""
    lane = libsumo.vehicle.getLaneID(actor_id)
    if not lane:
        return True
    to_end = libsumo.lane.getLength(lane) - libsumo.vehicle.getLanePosition(actor_id)
    if to_end >= _ARRIVAL_ZONE:
        return False
    return bool(libsumo.vehicle.getRoute(actor_id)[-1] == libsumo.vehicle.getRoadID(actor_id))


@lru_cache(maxsize=256)
def _logic(phases: tuple[SignalPhase, ...]) -> libsumo.trafficlight.Logic:
    """Returns a programme for SUMO; cached, since making it is slow."""
    return libsumo.trafficlight.Logic(
        _PROGRAM, 0, 0, [libsumo.trafficlight.Phase(p.duration, p.state) for p in phases]
    )


@dataclass(slots=True)
class _Process:
    """Whether this process has started SUMO."""

    started: bool = False


_process = _Process()


def is_started() -> bool:
    """Returns whether this process has started SUMO."""
    return _process.started
