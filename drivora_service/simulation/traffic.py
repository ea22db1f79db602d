"""SUMO's side of an episode: its vehicles, their control, entering and leaving."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from drivora_service.agents.sumo_driver import LaneChangeModel
from drivora_service.geometry.arrays import BoolArray, FloatArray
from drivora_service.simulation.background import LENGTH, WIDTH, Wanderers
from drivora_service.simulation.plan import DrivenPlan
from drivora_service.simulation.stand_ins import StandIns
from drivora_service.simulation.sumo import DrivenActor, MovedActor, SumoWorld

_DRIVER = "krauss"
_ROUTE_CHECK_STEPS = 20
_EDGES_LEFT = 4


@dataclass(frozen=True, slots=True, kw_only=True)
class Body:
    """The body with which a moved row enters SUMO.

    Attributes:
        on_lanes: Whether it keeps to ``edges``.
        is_fixed: Whether it never moves.
    """

    row: int
    id: str
    edges: tuple[str, ...]
    on_lanes: bool
    is_walker: bool
    is_fixed: bool
    length: float
    width: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Background:
    """The background traffic.

    Attributes:
        wanderers: Draws entries and routes.
        rows: (row, id) of each vehicle.
        clear: (n, 2) places where no vehicle may enter, metres: the starts of the egos.
        start_time: Seconds.
    """

    wanderers: Wanderers
    rows: tuple[tuple[int, str], ...]
    clear: FloatArray
    start_time: float


class Traffic:
    """Synchronizes SUMO's vehicles with the world's rows.

    Attributes:
        driven: Vehicles that SUMO drives now.
        is_moved, known, placements: Arrays of ``step_kernels.write_placements``.
    """

    def __init__(
        self,
        sumo: SumoWorld,
        stand_ins: StandIns,
        bodies: Sequence[Body],
        count: int,
        lane_change_model: LaneChangeModel = "LC2013",
    ) -> None:
        """Takes the bodies of a world of ``count`` rows, and SUMO's lane-change model."""
        self._sumo = sumo
        self._stand_ins = stand_ins
        self._driver = f"{_DRIVER}-{lane_change_model}"
        self._bodies: dict[int, Body] = {}
        for body in bodies:
            self.add_body(body)
        self._moved: dict[int, MovedActor] = {}
        self._moved_list: list[MovedActor] = []
        self.driven: list[DrivenActor] = []
        self._waiting: list[tuple[int, DrivenPlan]] = []
        self._entering: list[tuple[int, str, float]] = []
        self._background: Background | None = None
        self._tended = False
        self.known: BoolArray = np.zeros(0, dtype=np.bool_)
        self.make_room(count)

    def add_body(self, body: Body) -> None:
        """Announces a row that the service moves."""
        self._bodies[body.row] = body
        if body.is_fixed:
            self._stand_ins.fixed.add(body.row)

    def reserve(self, row: int) -> None:
        """Announces that a row will be handed over."""
        self._stand_ins.reserved.add(row)

    def fix(self, row: int) -> None:
        """Announces that a moved row is a wreck from now on."""
        self._stand_ins.fix(row)

    def make_room(self, count: int) -> None:
        """Resizes the arrays to a world of ``count`` rows, after bodies have been added."""
        known = np.zeros(count, dtype=np.bool_)
        known[: len(self.known)] = self.known
        self.known = known
        self.is_moved: BoolArray = np.zeros(count, dtype=np.bool_)
        self.is_moved[list(self._bodies)] = True
        for actor in self.driven:
            self.is_moved[actor.row] = False
        self.placements: FloatArray = np.zeros((count, 4))

    def add_driven(self, row: int, plan: DrivenPlan) -> None:
        """Announces an NPC that SUMO will drive from its start time on."""
        self._waiting.append((row, plan))

    def add_background(self, background: Background) -> None:
        """Announces the background traffic."""
        self._background = background

    def hand_over(self, row: int, speed: float, driver: str) -> None:
        """Hands a moved row over to one of SUMO's drivers."""
        actor = self._moved.pop(row)
        self._moved_list.remove(actor)
        self.is_moved[row] = False
        self.driven.append(self._sumo.hand_over(actor, speed, driver))

    def take_back(self, row: int, *, on_road: bool) -> None:
        """Takes back a row from SUMO's driver, or removes it if it has left the road.

        Its position in SUMO follows the world's rows from the next frame on, as before
        ``hand_over``.
        """
        actor = next(actor for actor in self.driven if actor.row == row)
        self.driven.remove(actor)
        self.is_moved[row] = True
        if not on_road:
            self.known[row] = False
            return
        moved = self._sumo.take_back(actor)
        self._moved[row] = moved
        self._moved_list.append(moved)

    def step(
        self, step: int, time: float, changes: int, frame: FloatArray, present: BoolArray
    ) -> None:
        """Sends a frame of moved rows to SUMO and completes it with SUMO's own vehicles.

        Args:
            step: Row of the frame.
            time: Seconds of the frame.
            changes: Number of moved rows that enter or leave with it.
            frame: (N, 9) the frame; rows that SUMO drives are filled in.
            present: (N,) of the frame; changed for rows that SUMO drives.
        """
        if changes:
            self._enter_and_leave(present)
        placements = self.placements.tolist()
        self._stand_ins.tend(self._moved_list, placements, frame)
        self._sumo.place(self._moved_list, placements)
        if self._waiting:
            self._start_driven(time)
        if self._background is not None and time >= self._background.start_time - 1e-9:
            self._tend_background(self._background, step, frame, present)
        self._sumo.step()
        if self.driven:
            self._sumo.read_driven(self.driven, frame, present)
        while self._entering:
            self._begin(*self._entering.pop(), frame, present)

    def _begin(
        self, row: int, actor_id: str, speed: float, frame: FloatArray, present: BoolArray
    ) -> None:
        """Slows a vehicle that has just entered to its initial speed."""
        now = float(np.hypot(frame[row, 3], frame[row, 4])) if present[row] else 0.0
        if now > speed:
            self._sumo.set_speed_now(actor_id, speed)
            frame[row, 3:5] *= speed / now

    def _enter_and_leave(self, next_present: BoolArray) -> None:
        for row in np.flatnonzero(self.is_moved & (next_present != self.known)).tolist():
            body = self._bodies[row]
            if next_present[row]:
                actor = self._sumo.add_moved(
                    row,
                    body.id,
                    body.edges,
                    length=body.length,
                    width=body.width,
                    is_walker=body.is_walker,
                    follows_route=body.on_lanes,
                )
                actor.watched = body.is_walker or body.is_fixed
                self._moved[row] = actor
                self._moved_list.append(actor)
                self.placements[row, 3] = 1.0
            else:
                actor = self._moved.pop(row)
                self._moved_list.remove(actor)
                self._stand_ins.forget(row)
                self._sumo.remove(body.id)
            self.known[row] = next_present[row]

    def _start_driven(self, time: float) -> None:
        due = [entry for entry in self._waiting if entry[1].start_time <= time + 1e-9]
        for row, plan in due:
            self._waiting.remove((row, plan))
            self.driven.append(
                self._sumo.add_driven(
                    row,
                    plan.id,
                    plan.edges,
                    driver=self._driver,
                    length=plan.model.length,
                    width=plan.model.width,
                    lane_number=plan.lane_number,
                    position=plan.position,
                    arrival=plan.arrival,
                )
            )
            self._entering.append((row, plan.id, plan.speed))

    def _tend_background(
        self,
        background: Background,
        step: int,
        next_frame: FloatArray,
        next_present: BoolArray,
    ) -> None:
        """Adds missing vehicles and extends routes that run out."""
        if self._tended and step % _ROUTE_CHECK_STEPS:
            return
        self._tended = True
        wanderers = background.wanderers
        by_row = {actor.row: actor for actor in self.driven}
        taken = np.concatenate((background.clear, next_frame[next_present, :2]))
        for row, vehicle in background.rows:
            if row not in by_row:
                place = wanderers.entry(taken)
                if place is None:
                    continue
                lane, s = place
                x, y, _ = lane.position_at(s)
                taken = np.concatenate((taken, [(x, y)]))
                self.driven.append(
                    self._sumo.add_driven(
                        row,
                        vehicle,
                        wanderers.route_from(lane.edge_id),
                        driver=self._driver,
                        length=LENGTH,
                        width=WIDTH,
                        lane_number=lane.lane_number,
                        position=s,
                        arrival=None,
                    )
                )
            elif not self._sumo.knows(vehicle):
                self.driven.remove(by_row[row])
            elif self._sumo.remaining_edges(vehicle) < _EDGES_LEFT:
                more = wanderers.route_from(self._sumo.last_edge(vehicle))[1:]
                if more:
                    self._sumo.extend_route(vehicle, more)
