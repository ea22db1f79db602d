"""SUMO's side of an episode: who is known to SUMO, who moves them, who enters and leaves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drivora_service.simulation.background import LENGTH, WIDTH, Wanderers
from drivora_service.simulation.plan import DrivenPlan
from drivora_service.simulation.step_kernels import write_placements
from drivora_service.simulation.sumo import DrivenActor, MovedActor, SumoWorld

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

_DRIVER = "krauss-LC2013"
_ROUTE_CHECK_STEPS = 20
_EDGES_LEFT = 4


@dataclass(frozen=True, slots=True, kw_only=True)
class Body:
    """How a moved row enters SUMO."""

    row: int
    id: str
    edges: tuple[str, ...]
    on_lanes: bool
    is_walker: bool
    length: float
    width: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Background:
    """The background traffic.

    Attributes:
        wanderers: Draws entries and routes.
        rows: (row, id) of each vehicle.
        clear: (n, 2) places where none may enter, metres: the starts of the egos.
        start_time: Seconds.
    """

    wanderers: Wanderers
    rows: tuple[tuple[int, str], ...]
    clear: FloatArray
    start_time: float


class Traffic:
    """Keeps SUMO's vehicles in step with the world's rows.

    Attributes:
        driven: Vehicles that SUMO drives now.
    """

    def __init__(self, sumo: SumoWorld, bodies: Sequence[Body]) -> None:
        self._sumo = sumo
        self._bodies = {body.row: body for body in bodies}
        self._moved: dict[int, MovedActor] = {}
        self._moved_list: list[MovedActor] = []
        self.driven: list[DrivenActor] = []
        self._waiting: list[tuple[int, DrivenPlan]] = []
        self._entering: list[tuple[int, str, float]] = []
        self._background: Background | None = None
        self._tended = False
        self._known = np.zeros(0, dtype=np.bool_)
        self._is_moved = np.zeros(0, dtype=np.bool_)
        self._placements: FloatArray = np.empty((0, 4))

    def add_body(self, body: Body) -> None:
        """Announces a row that the service moves."""
        self._bodies[body.row] = body
        self._is_moved = np.zeros(0, dtype=np.bool_)

    def add_driven(self, row: int, plan: DrivenPlan) -> None:
        """Announces an NPC that SUMO will drive from its start time on."""
        self._waiting.append((row, plan))

    def add_background(self, background: Background) -> None:
        """Announces the background traffic."""
        self._background = background

    def hand_over(self, row: int, speed: float, driver: str) -> None:
        """Lets one of SUMO's drivers take over a row that was moved until now."""
        actor = self._moved.pop(row)
        self._moved_list.remove(actor)
        self._is_moved[row] = False
        self.driven.append(self._sumo.hand_over(actor, speed, driver, self._bodies[row].width))

    def take_back(self, row: int, *, on_road: bool) -> None:
        """Moves a row again that SUMO drove until now, or forgets it if it has left the road."""
        actor = next(actor for actor in self.driven if actor.row == row)
        self.driven.remove(actor)
        if not on_road:
            self._known[row] = False
            return
        moved = self._sumo.take_back(actor)
        self._moved[row] = moved
        self._moved_list.append(moved)

    def step(
        self,
        step: int,
        time: float,
        frame: FloatArray,
        present: BoolArray,
        next_frame: FloatArray,
        next_present: BoolArray,
        sizes: FloatArray,
    ) -> None:
        """Shows SUMO the next frame of moved rows and completes it with SUMO's own vehicles.

        Args:
            step: Row of the next frame.
            time: Seconds of the next frame.
            frame: (N, 8) this frame.
            present: (N,) of this frame.
            next_frame: (N, 8) next frame; rows that SUMO drives are filled in.
            next_present: (N,) of the next frame; changed for rows that SUMO drives.
            sizes: (N, 2) metres.
        """
        if len(self._is_moved) != len(next_present):
            self._fit(len(next_present))
        changes = write_placements(
            frame, present, next_frame, next_present, sizes, self._is_moved, self._known,
            self._placements,
        )  # fmt: skip
        if changes:
            self._enter_and_leave(next_present)
        self._sumo.place(self._moved_list, self._placements.tolist())
        if self._waiting:
            self._start_driven(time)
        if self._background is not None and time >= self._background.start_time - 1e-9:
            self._tend_background(self._background, step, next_frame, next_present)
        self._sumo.step()
        if self.driven:
            self._sumo.read_driven(self.driven, next_frame, next_present)
        while self._entering:
            self._begin(*self._entering.pop(), next_frame, next_present)

    def _begin(
        self, row: int, actor_id: str, speed: float, frame: FloatArray, present: BoolArray
    ) -> None:
        """Slows a vehicle that has just entered to the speed that it is to begin with."""
        now = float(np.hypot(frame[row, 3], frame[row, 4])) if present[row] else 0.0
        if now > speed:
            self._sumo.set_speed_now(actor_id, speed)
            frame[row, 3:5] *= speed / now

    def _fit(self, count: int) -> None:
        known = np.zeros(count, dtype=np.bool_)
        known[: len(self._known)] = self._known
        self._known = known
        self._is_moved = np.zeros(count, dtype=np.bool_)
        self._is_moved[list(self._bodies)] = True
        for actor in self.driven:
            self._is_moved[actor.row] = False
        self._placements = np.zeros((count, 4))

    def _enter_and_leave(self, next_present: BoolArray) -> None:
        for row in np.flatnonzero(self._is_moved & (next_present != self._known)).tolist():
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
                self._moved[row] = actor
                self._moved_list.append(actor)
                self._placements[row, 3] = 1.0
            else:
                actor = self._moved.pop(row)
                self._moved_list.remove(actor)
                self._sumo.remove(body.id)
            self._known[row] = next_present[row]

    def _start_driven(self, time: float) -> None:
        due = [entry for entry in self._waiting if entry[1].start_time <= time + 1e-9]
        for row, plan in due:
            self._waiting.remove((row, plan))
            self.driven.append(
                self._sumo.add_driven(
                    row,
                    plan.id,
                    plan.edges,
                    driver=_DRIVER,
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
        """Lets vehicles in that are missing and lengthens routes that run out."""
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
                        driver=_DRIVER,
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
