"""Which actors SUMO can do without being told of for a while.

What SUMO drives depends on a vehicle that the service moves by its place, where that is near; and,
however far, by the lane that the vehicle is on: vehicles on a lane draw from a stream of random
numbers that lanes share, count as occupying it, and keep it among the lanes that SUMO goes through
in a certain order. So a vehicle that is far from all that SUMO drives is held where it
is, standing, for as long as it would stay on the same lane; it is placed again before it leaves
the lane, or comes near.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from drivora_service.agents.sumo_driver import SumoDriver
from drivora_service.compilation import specialize
from drivora_service.geometry.array_shapes import BoolArray, FloatArray, IntArray
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.simulation.motion.vehicle_dynamics import GRAVITY
from drivora_service.simulation.plans.episode_plan import DrivenPlan
from drivora_service.simulation.traffic.holding_kernel import (
    Drivers,
    EntryCol,
    HeldRows,
    Spot,
    hold,
)
from drivora_service.simulation.traffic.lane_cores import lane_cores
from drivora_service.simulation.world import WorldFrames

_SPEEDING = 1.2
"""How much faster than the limit SUMO's drivers go, at most."""
_DECELERATION = 4.5
"""m/s² with which SUMO's drivers brake."""
_LEAST_DECELERATION = 0.1
_LOOKS = 3.0
"""Number of times the way of braking by which an actor must be away: an actor near a driver may
react to another one, and a driver that changes lanes looks ten seconds ahead."""
_NEAR_SIGHTED = frozenset({"krauss"})
"""Car-following models whose drivers react to nothing beyond the way of braking."""


def reach_of(network: RoadNetwork, friction: float) -> float:
    """Returns the distance in metres beyond which a vehicle counts as far from another.

    A driver looks ahead by the way of a second and of braking at the highest speed there.
    """
    fastest = _SPEEDING * max((lane.speed_limit for lane in network.lanes), default=0.0)
    braking = max(min(_DECELERATION, friction * GRAVITY), _LEAST_DECELERATION)
    return _LOOKS * (fastest + fastest**2 / (2.0 * braking))


def look_ahead_is_bounded(agents: Iterable[object]) -> bool:
    """Returns whether all of SUMO's drivers of a run's egos see only what is near.

    IDM, EIDM and ACC react in the last digits to a vehicle on their way at any distance: to one 480
    metres ahead on the next lane, in an experiment. SUMO's other vehicles are driven by Krauss.
    """
    return all(a.car_following in _NEAR_SIGHTED for a in agents if isinstance(a, SumoDriver))


class Holding:
    """The moved rows of a run that SUMO does not get."""

    def __init__(self, network: RoadNetwork, friction: float) -> None:
        """Finds the lanes on which rows can be held.

        Args:
            network: The road network.
            friction: Tyre-road friction coefficient.
        """
        self._network = network
        self._reach = reach_of(network, friction)
        self._lanes = lane_cores(network)
        self._entries: dict[int, tuple[float, float, float]] = {}
        self._ways: dict[int, tuple[int, ...]] = {}
        self._kernel = hold
        self._resize(np.zeros(0, dtype=np.bool_))

    def _resize(self, drives: BoolArray) -> None:
        """Makes the arrays anew for as many rows as ``drives`` has, none of which is held."""
        count = len(drives)
        self._rows = HeldRows(
            lane=np.full(count, -1, dtype=np.int64),
            cursor=np.zeros(count, dtype=np.int64),
            is_held=np.zeros(count, dtype=np.bool_),
            spots=np.zeros((count, len(Spot))),
            next_ask=np.zeros(count, dtype=np.int64),
            asked=np.zeros(count, dtype=np.int64),
        )
        # Egos that SUMO drives may leave their routes.
        on_way = np.ones((count, len(self._network.lanes)), dtype=np.bool_)
        self._drivers = Drivers(drives, np.full((count, len(EntryCol)), np.nan), on_way)
        for row, place in self._entries.items():
            self._drivers.entries[row] = place
        for row, lanes in self._ways.items():
            on_way[row] = False
            on_way[row, list(lanes)] = True

    @property
    def asked(self) -> IntArray:
        """(N,) rows whose lanes ``answer`` is to be told next."""
        return self._rows.asked

    def expect(self, row: int, plan: DrivenPlan) -> None:
        """Announces an NPC that SUMO will drive: where it enters is kept clear until then."""
        lane = self._network.lane(f"{plan.edges[0]}_{plan.lane_number}")
        along = plan.position * float(lane.arc[-1]) / lane.length
        self._entries[row] = lane.position_at(along)
        edges = self._network.edge_lanes
        self._ways[row] = tuple(lane for edge in plan.edges for lane in edges[edge])

    def choose(
        self,
        step: int,
        frames: WorldFrames,
        drives: BoolArray,
        may: BoolArray,
        placements: FloatArray,
    ) -> int:
        """Marks the placements of the rows that are held in a frame.

        Args:
            step: The frame's number.
            frames: The frames of the world up to the one before.
            drives: (N,) rows that SUMO drives, or will.
            may: (N,) rows that may be held.
            placements: (N, 4) of the frame, columns ``step_kernels.PlacementCol``; ``MOVED``
                becomes ``HELD`` where a row is held.

        Returns:
            The number of filled rows of ``asked``: their lanes are needed.
        """
        if len(self._rows.lane) != len(drives):
            self._resize(drives)
        elif self._drivers.drives is not drives:
            self._drivers = self._drivers._replace(drives=drives)
        count = self._kernel(
            step, self._reach, frames, may, placements, self._lanes, self._drivers, self._rows
        )
        if self._kernel is hold:
            # Later calls have arguments of the same types.
            self._kernel = specialize(hold)
        return int(count)

    def answer(self, row: int, lane: str) -> None:
        """Takes the id of the lane on which SUMO has a row; "" if it is on none."""
        self._rows.lane[row] = self._network.lane_by_id.get(lane, -1)
        self._rows.cursor[row] = 0
