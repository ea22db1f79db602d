"""SUMO's side of an episode: its vehicles, their control, entering and leaving.

SUMO is brought up to the present only where that can be noticed: while SUMO drives a vehicle, and
when a caller asks for it. Until then it lags behind the world, whose frames hold all that it has to
be told; it catches up by the same calls in the same order as if it had been told at every step, so
neither traces nor SUMO's state depend on when. Where SUMO drives no vehicle in a whole run, it is
not even opened.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from drivora_service.agents.sumo_driver import LaneChangeModel
from drivora_service.geometry.array_shapes import BoolArray, FloatArray
from drivora_service.observations.trace import Col
from drivora_service.simulation.motion.step_kernels import MovedRows, PlacementCol, write_placements
from drivora_service.simulation.plans.episode_plan import DrivenPlan
from drivora_service.simulation.sumo import DrivenActor, MovedActor, SumoWorld
from drivora_service.simulation.traffic.background_vehicles import BackgroundVehicles
from drivora_service.simulation.traffic.holding import Holding
from drivora_service.simulation.traffic.lane_order import LaneOrder
from drivora_service.simulation.traffic.stand_ins import StandIns
from drivora_service.simulation.traffic.sumo_patches import SumoPatches
from drivora_service.simulation.world import World

_CHECK_STEPS = 20
"""Steps after which it is checked again whether vehicles that SUMO drives have left for good."""
_DRIVER = "krauss"


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


class Traffic:
    """Synchronizes SUMO's vehicles with the world's rows.

    Attributes:
        driver: SUMO's driver of NPCs and background traffic, a vehicle type.
        driven: Vehicles that SUMO drives now.
        moved: The rows that the service moves; another record after ``make_room``.
    """

    def __init__(
        self,
        sumo: SumoWorld,
        stand_ins: StandIns,
        world: World,
        bodies: Sequence[Body],
        *,
        lane_change_model: LaneChangeModel = "LC2013",
        sublanes: bool = False,
        open_sumo: Callable[[], None],
        mirrored: bool,
        holding: Callable[[], Holding] | None = None,
        patches: SumoPatches | None = None,
    ) -> None:
        """Takes the bodies of a world.

        Args:
            sumo: The simulation in SUMO, not open yet.
            stand_ins: Its stand-ins.
            world: The frames, which SUMO catches up with.
            bodies: Bodies of the rows that the service moves.
            lane_change_model: SUMO's lane-change model.
            sublanes: Whether SUMO may not take a vehicle off its lanes; see ``StandIns``.
            open_sumo: Opens ``sumo`` and sets it up.
            mirrored: Whether SUMO never lags.
            holding: Makes what holds rows far from what SUMO drives; ``None``: all are placed.
            patches: Slippery places of the road, if there are any.
        """
        self._sumo = sumo
        self._stand_ins = stand_ins
        self._world = world
        self._open_sumo = open_sumo
        self._mirrored = mirrored
        self._make_holding = holding
        self._patches = patches
        self._order = None if sublanes else LaneOrder(sumo, world)
        self._holding: Holding | None = None
        self.driver = f"{_DRIVER}-{lane_change_model}"
        self._bodies: dict[int, Body] = {}
        for body in bodies:
            self.add_body(body)
        self._moved: dict[int, MovedActor] = {}
        self._moved_list: list[MovedActor] = []
        self.driven: list[DrivenActor] = []
        self._now = self._reached = -1
        self._wrecks: list[tuple[int, int]] = []
        self._waiting: list[tuple[int, DrivenPlan]] = []
        self._next_start = self._next_due = math.inf
        self._npcs: set[int] = set()
        self._entering: list[tuple[int, str, float]] = []
        self._background: BackgroundVehicles | None = None
        self._reserved: list[int] = []
        self.moved = _no_rows(0)
        self.make_room()

    def add_body(self, body: Body) -> None:
        """Announces a row that the service moves."""
        self._bodies[body.row] = body
        if body.is_fixed:
            self._stand_ins.fixed.add(body.row)

    def reserve(self, row: int) -> None:
        """Announces that a row will be handed over."""
        self._stand_ins.reserved.add(row)
        self._reserved.append(row)
        self._settle_roles()

    def fix(self, row: int) -> None:
        """Announces that a moved row is a wreck from the next frame on."""
        if self._reached == self._now:
            self._stand_ins.fix(row)
        else:
            self._wrecks.append((self._now, row))

    def make_room(self) -> None:
        """Resizes the arrays to the world's rows, after bodies have been added."""
        count = len(self._world.actors)
        before = self.moved.known
        self.moved = _no_rows(count)
        self.moved.known[: len(before)] = before
        self.moved.is_moved[list(self._bodies)] = True
        for actor in self.driven:
            self.moved.is_moved[actor.row] = False
        self._settle_roles()

    def _settle_roles(self) -> None:
        """Notes which rows SUMO drives, or will, and which may be held far from those."""
        self._drives: BoolArray = ~self.moved.is_moved
        self._drives[self._reserved] = True
        keep_to_lanes = np.zeros(len(self._drives), dtype=np.bool_)
        keep_to_lanes[[body.row for body in self._bodies.values() if body.on_lanes]] = True
        self._may_hold: BoolArray = keep_to_lanes & ~self._drives

    def add_driven(self, row: int, plan: DrivenPlan) -> None:
        """Announces an NPC that SUMO will drive from its start time on."""
        self._waiting.append((row, plan))
        self._npcs.add(row)
        self._note_due()

    def add_background(self, background: BackgroundVehicles) -> None:
        """Announces the background traffic."""
        self._background = background
        self._note_due()

    def hand_over(self, row: int, speed: float, driver: str) -> None:
        """Hands a moved row over to one of SUMO's drivers."""
        self.catch_up()
        actor = self._moved.pop(row)
        self._moved_list.remove(actor)
        self.moved.is_moved[row] = False
        self._settle_roles()
        self.driven.append(self._sumo.hand_over(actor, speed, driver))

    def take_back(self, row: int, *, on_road: bool) -> None:
        """Takes back a row from SUMO's driver, or removes it if it has left the road.

        Its position in SUMO follows the world's rows from the next frame on, as before
        ``hand_over``.
        """
        actor = next(actor for actor in self.driven if actor.row == row)
        self.driven.remove(actor)
        self.moved.is_moved[row] = True
        self._settle_roles()
        if not on_road:
            self.moved.known[row] = False
            return
        moved = self._sumo.take_back(actor)
        self._moved[row] = moved
        self._moved_list.append(moved)

    @property
    def keeps_up(self) -> bool:
        """Whether SUMO is at the present frame and will be told of the next one."""
        return bool(self.driven or self._mirrored) and self._reached == self._now >= 0

    def step(self, step: int, time: float, changes: int) -> None:
        """Completes a frame of moved rows with SUMO's own vehicles.

        Args:
            step: Row of the frame; those that SUMO drives are filled in.
            time: Seconds of the frame.
            changes: Number of moved rows that enter or leave with it; negative if its placements
                have not been written, as SUMO did not keep up.
        """
        self._now = step
        if not (self.driven or self._mirrored) and time + 1e-9 < self._next_due:
            return
        if self._reached < step - 1:
            self._replay(step - 1)
        elif self._reached < 0:
            self._open()
        if changes < 0:
            changes = self._write_placements(step)
        if self._holding is not None and self.driven and step:
            self._hold(self._holding, step)
        frame, present = self._world.states[step], self._world.present[step]
        self._send_to_sumo(step, changes)
        if time + 1e-9 >= self._next_start:
            self._start_driven(time)
        if self._background is not None and self._background.is_due(time):
            self._background.tend(self._sumo, self.driven, step, frame, present)
        self._sumo.step()
        self._reached = step
        if self.driven:
            self._sumo.read_driven(self.driven, frame, present)
            if self._patches is not None:
                self._patches.tend(self.driven, frame, present)
            if step % _CHECK_STEPS == 0:
                self._forget_gone(present)
        while self._entering:
            self._begin(*self._entering.pop(), frame, present)

    def catch_up(self) -> None:
        """Brings SUMO up to the present frame."""
        if self._reached < self._now:
            self._replay(self._now)

    def _replay(self, last: int) -> None:
        """Simulates the frames that SUMO has not seen in it, up to ``last``; it drives no vehicle.

        Poses in a frame do not change after it has been made, so the calls are those that would
        have been made at the time.
        """
        if self._reached < 0:
            self._open()
        for k in range(self._reached + 1, last + 1):
            self._send_to_sumo(k, self._write_placements(k))
            self._sumo.step()
            self._reached = k
            while self._wrecks and self._wrecks[0][0] <= k:
                self._stand_ins.fix(self._wrecks.pop(0)[1])

    def _open(self) -> None:
        self._open_sumo()
        # Background traffic enters anywhere, at any time.
        if self._make_holding is not None and self._background is None:
            self._holding = self._make_holding()
            for row, plan in self._waiting:
                self._holding.expect(row, plan)

    def _hold(self, holding: Holding, step: int) -> None:
        """Chooses the rows that are held in a frame; rows enter far from no vehicle of SUMO."""
        world = self._world
        count = holding.choose(
            step, world.frames, self._drives, self._may_hold, self.moved.placements
        )
        for row in holding.asked[:count].tolist():
            actor = self._moved.get(row)
            if actor is not None and actor.keeps_to_route:
                holding.answer(row, self._sumo.lane_of(actor.id))

    def _write_placements(self, k: int) -> int:
        """Writes the placements of a frame; returns how many moved rows enter or leave with it."""
        world = self._world
        # Before the first frame no actor is present.
        before = world.present[k - 1] if k else np.zeros_like(world.present[0])
        return write_placements(
            world.states[k - 1], before, world.states[k], world.present[k], world.sizes, self.moved
        )

    def _send_to_sumo(self, k: int, changes: int) -> None:
        """Has moved rows enter, leave, and be at their places of a frame in SUMO's next step."""
        frame, present = self._world.states[k], self._world.present[k]
        if changes:
            self._enter_and_leave(present)
        if self._order is not None:
            self._order.tend(k, self.moved.is_moved, self._moved)
        placements = self.moved.placements.tolist()
        self._stand_ins.tend(self._moved_list, placements, frame)
        self._sumo.place(self._moved_list, placements)

    def _begin(
        self, row: int, actor_id: str, speed: float, frame: FloatArray, present: BoolArray
    ) -> None:
        """Slows a vehicle that has just entered to its initial speed."""
        now = float(np.hypot(frame[row, Col.VX], frame[row, Col.VY])) if present[row] else 0.0
        if now > speed:
            self._sumo.set_speed_now(actor_id, speed)
            frame[row, Col.VX : Col.VY + 1] *= speed / now

    def _enter_and_leave(self, next_present: BoolArray) -> None:
        is_moved, known, placements = self.moved
        for row in np.flatnonzero(is_moved & (next_present != known)).tolist():
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
                placements[row, PlacementCol.MOVED] = 1.0
            else:
                actor = self._moved.pop(row)
                self._moved_list.remove(actor)
                self._stand_ins.forget(row)
                self._sumo.remove(body.id)
            known[row] = next_present[row]

    def _start_driven(self, time: float) -> None:
        due = [entry for entry in self._waiting if entry[1].start_time <= time + 1e-9]
        for row, plan in due:
            self._waiting.remove((row, plan))
            self.driven.append(
                self._sumo.add_driven(
                    row,
                    plan.id,
                    plan.edges,
                    driver=self.driver,
                    length=plan.model.length,
                    width=plan.model.width,
                    lane_number=plan.lane_number,
                    position=plan.position,
                    arrival=plan.arrival,
                    has_speed=True,
                )
            )
            self._entering.append((row, plan.id, plan.speed))
        self._note_due()

    def _note_due(self) -> None:
        """Notes when the next vehicle enters that SUMO drives."""
        self._next_start = min((plan.start_time for _, plan in self._waiting), default=math.inf)
        start = math.inf if self._background is None else self._background.start_time
        self._next_due = min(self._next_start, start)

    def _forget_gone(self, present: BoolArray) -> None:
        """Forgets NPCs that have left SUMO at their destinations."""
        absent = [a for a in self.driven if a.row in self._npcs and not present[a.row]]
        known = self._sumo.known_ids() if absent else frozenset()
        for actor in absent:
            if actor.id not in known:
                self.driven.remove(actor)


def _no_rows(count: int) -> MovedRows:
    """Returns the arrays for as many rows, none of which is moved or known to SUMO."""
    return MovedRows(
        is_moved=np.zeros(count, dtype=np.bool_),
        known=np.zeros(count, dtype=np.bool_),
        placements=np.zeros((count, len(PlacementCol))),
    )
