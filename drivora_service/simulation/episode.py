"""One episode: reset, step until it ends, look at it on the way, take its trace.

Row ``k`` of the world is the state at ``k * step_length`` seconds. A step lets every agent decide
on row ``k``, moves what the service moves to row ``k + 1``, shows that to SUMO, lets SUMO move its
own vehicles, and then looks what happened.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drivora_service.agents.interface import Agent, Control
from drivora_service.agents.sumo_driver import SumoDriver
from drivora_service.errors import SimulatorError
from drivora_service.observations.trace import Actor, Col, Contact, Role, TerminalEvent, Trace
from drivora_service.scenario.model import NpcBehavior, NpcVehicle, NpcWalker
from drivora_service.simulation import background
from drivora_service.simulation.arrays import append_follower, lay_followers
from drivora_service.simulation.contacts import find_contacts
from drivora_service.simulation.dynamics import CommandMode
from drivora_service.simulation.ego_team import EgoTeam
from drivora_service.simulation.followers import advance_followers
from drivora_service.simulation.plan import (
    EpisodePlan,
    FollowerPlan,
    plan_driven,
    plan_npc,
    plan_walker,
)
from drivora_service.simulation.step_kernels import (
    ENDS,
    begin_frame,
    take_over_driven,
    write_egos,
    write_rates,
)
from drivora_service.simulation.sumo import open_world
from drivora_service.simulation.trace_assembly import Record, assemble_trace
from drivora_service.simulation.traffic import Background, Body, Traffic
from drivora_service.simulation.world import World

_ROOM_FOR_CONTACTS = 64


@dataclass(frozen=True, slots=True, kw_only=True)
class ActorState:
    """One actor as it is now: metres, radians, m/s."""

    id: str
    role: Role
    model: str
    x: float
    y: float
    yaw: float
    speed: float
    length: float
    width: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Look:
    """The episode as it is now.

    Attributes:
        time: Seconds of simulation.
        step: Row of the trace.
        actors: Who is in the world, egos first.
        done: Whether the episode has ended.
    """

    time: float
    step: int
    actors: tuple[ActorState, ...]
    done: bool


class Episode:
    """A running episode. A process runs one at a time, since it holds one SUMO.

    Running a whole one is a loop::

        episode = Episode(plan, agents)
        while not episode.done:
            episode.step()
        trace = episode.finish()
    """

    def __init__(
        self,
        plan: EpisodePlan,
        agents: Sequence[Agent | SumoDriver],
        *,
        privileged: Sequence[bool] = (),
        cells: NDArray[np.int64] | None = None,
    ) -> None:
        """Resets SUMO, sets the agents up and makes row 0.

        Args:
            plan: What to simulate.
            agents: One for every ego, in order.
            privileged: Which agents see more than the perception model lets through.
            cells: (4,) progress integers to keep current (``runs.progress``).

        Raises:
            AgentError: If an agent fails in ``setup_env``.
            SimulatorError: If SUMO refuses the network or an actor.
        """
        self.plan = plan
        self.done = False
        self._dt = plan.scenario.step_length
        self._k = 0
        self._has_sumo_drivers = any(isinstance(agent, SumoDriver) for agent in agents)
        self._privileged = tuple(privileged) or (False,) * len(agents)
        self._cells = np.zeros(4, dtype=np.int64) if cells is None else cells
        self._team = EgoTeam(plan, agents, self._cells)
        self._contacts: list[Contact] = []
        self._late_obstacles: list[tuple[float, int, NDArray[np.float64]]] = []
        self._found = np.zeros((_ROOM_FOR_CONTACTS, 2), dtype=np.int64)
        actors, bodies, follower_rows = self._cast()
        self._world = World(
            actors,
            len(plan.egos),
            len(self._team.log_names),
            expected_rows=int(plan.max_sim_time / self._dt) + 2,
        )
        self._followers = lay_followers(plan.followers, follower_rows)
        self._static = np.array([actor.role is Role.NPC_OBSTACLE for actor in actors])
        self._seen = np.zeros((len(plan.egos), len(actors)), dtype=np.bool_)
        slippery = plan.weather.friction < 1.0
        self._sumo = open_world(
            plan.network.path,
            step_length=self._dt,
            seed=plan.scenario.seed,
            slippery=slippery,
        )
        if slippery:
            edges = [edge for edge in plan.network.edge_lanes if not edge.startswith(":")]
            self._sumo.set_friction(edges, plan.weather.friction)
        # SUMO switches at the beginning of a step: what it shows after the step that makes row 0 is
        # what the programmes say of time 0.
        self._sumo.set_programs(plan.programs, 0.0)
        self._traffic = Traffic(self._sumo, bodies)
        self._announce(actors)
        self._make_first_frame()

    @property
    def time(self) -> float:
        """Seconds of simulation."""
        return self._k * self._dt

    def _cast(self) -> tuple[list[Actor], list[Body], list[int]]:
        """Gives every actor a row: egos, followers, driven NPCs, obstacles, background."""
        actors: list[Actor] = []
        bodies: list[Body] = []
        follower_rows: list[int] = []

        def add(actor_id: str, role: Role, model: str, length: float, width: float) -> int:
            row = len(actors)
            actors.append(
                Actor(row=row, id=actor_id, role=role, model=model, length=length, width=width)
            )
            return row

        for ego in self.plan.egos:
            size = ego.model
            row = add(ego.ego.id, Role.EGO, size.name, size.length, size.width)
            bodies.append(_body(actors[row], ego.route.edges, on_lanes=True))
        for follower in self.plan.followers:
            follower_rows.append(len(actors))
            actors.append(_follower_actor(follower, len(actors)))
            bodies.append(_body(actors[-1], follower.edges, on_lanes=follower.on_lanes))
        for driven in self.plan.driven:
            size = driven.model
            add(driven.id, Role.NPC_VEHICLE, size.name, size.length, size.width)
        for item in self.plan.obstacles:
            row = add(item.obstacle.id, Role.NPC_OBSTACLE, item.model.name, item.length, item.width)
            bodies.append(_body(actors[row], (item.edge,), on_lanes=False))
        flow = self.plan.scenario.background_traffic
        for number in range(0 if flow is None else flow.count):
            add(
                f"background:{number}",
                Role.BACKGROUND,
                background.MODEL,
                background.LENGTH,
                background.WIDTH,
            )
        return actors, bodies, follower_rows

    def _announce(self, actors: Sequence[Actor]) -> None:
        """Tells the traffic whom SUMO will drive."""
        rows = {actor.id: actor.row for actor in actors}
        for driven in self.plan.driven:
            self._traffic.add_driven(rows[driven.id], driven)
        flow = self.plan.scenario.background_traffic
        if flow is None or not flow.count:
            return
        rng = np.random.default_rng(np.random.SeedSequence([self.plan.scenario.seed, 1]))
        self._traffic.add_background(
            Background(
                wanderers=background.Wanderers(
                    self.plan.network, self.plan.scenario.map_region.region_segment, rng
                ),
                rows=tuple(
                    (actor.row, actor.id) for actor in actors if actor.role is Role.BACKGROUND
                ),
                clear=np.concatenate(
                    [background.clearance_points(*ego.start[:2]) for ego in self.plan.egos]
                ),
                start_time=flow.start_time,
            )
        )

    def _make_first_frame(self) -> None:
        states, present = self._world.states, self._world.present
        states[0] = np.nan
        for item in self.plan.obstacles:
            row = next(a.row for a in self._world.actors if a.id == item.obstacle.id)
            states[0, row] = (*item.pose, 0.0, 0.0, 0.0, 0.0, 0.0, item.height)
            present[0, row] = item.obstacle.start_time <= 0.0
            if item.obstacle.start_time > 0.0:
                self._late_obstacles.append((item.obstacle.start_time, row, states[0, row].copy()))
        nobody = np.zeros_like(present[0])
        self._team.start_due(0.0)
        self._move(states[0], nobody, states[0], present[0], 0.0)
        self._hand_over_started(range(len(self.plan.egos)))
        self._look_around(0, 0.0)

    def _move(
        self,
        frame: NDArray[np.float64],
        present: NDArray[np.bool_],
        next_frame: NDArray[np.float64],
        next_present: NDArray[np.bool_],
        next_time: float,
    ) -> None:
        """Completes the next frame: egos, followers, then SUMO's own vehicles."""
        dt, f = self._dt, self._followers
        write_egos(self._team.bodies, self._team.in_world, next_frame, next_present)
        if len(f.rows):
            advance_followers(
                next_time - dt, dt, self.plan.weather.friction, f.rows, f.first, f.line, f.yaw,
                f.arc, f.wanted, f.height, f.s, f.speed, f.cursor, f.phase, f.start_time,
                f.reaction, f.stays, f.max_acceleration, f.max_deceleration, f.length, f.width,
                frame, self._world.sizes, present, next_frame, next_present,
            )  # fmt: skip
        self._traffic.step(
            self._k + 1, next_time, frame, present, next_frame, next_present, self._world.sizes
        )
        write_rates(frame, present, next_frame, next_present, dt)
        if self._has_sumo_drivers:
            take_over_driven(
                self._team.bodies, self._team.modes == CommandMode.EXTERNAL, next_frame, dt
            )

    def _hand_over_started(self, rows: Sequence[int]) -> None:
        for m in rows:
            agent = self._team.agents[m]
            if self._team.active[m] and isinstance(agent, SumoDriver):
                self._traffic.hand_over(m, self.plan.egos[m].ego.initial_speed, agent.type_id)
                self._team.modes[m] = CommandMode.EXTERNAL

    def step(self, controls: Mapping[str, Control] | None = None) -> bool:
        """Simulates one step.

        Args:
            controls: Controls by ego id that are taken in place of asking the ego's agent.

        Returns:
            Whether the episode has ended.

        Raises:
            AgentError: If an agent raises or answers what is no control.
            SimulatorError: If the episode has ended already, or ``controls`` names no ego.
        """
        if self.done:
            raise SimulatorError("the episode has ended: make a new one to go on")
        if controls:
            self._check_egos(controls)
        world, k = self._world, self._k
        if k + 1 >= world.capacity:
            world.grow()
        time, next_time = k * self._dt, (k + 1) * self._dt
        self._cells[1] = k
        started = self._team.start_due(time) if k else []
        if started:
            self._hand_over_started(started)
        self._team.decide(k, time, world, controls)
        frame, next_frame = world.states[k], world.states[k + 1]
        present, next_present = world.present[k], world.present[k + 1]
        begin_frame(frame, present, next_frame, next_present, self._static)
        if self._late_obstacles:
            self._put_late_obstacles(next_time, next_frame, next_present)
        self._team.drive()
        self._move(frame, present, next_frame, next_present, next_time)
        self._k = k + 1
        self._look_around(k + 1, next_time)
        return self.done

    def _check_egos(self, ids: Iterable[str]) -> None:
        egos = [ego.ego.id for ego in self.plan.egos]
        for ego in ids:
            if ego not in egos:
                known = ", ".join(egos)
                raise SimulatorError(f"there is no ego {ego!r} to control; egos: {known}")

    def _put_late_obstacles(
        self, time: float, frame: NDArray[np.float64], present: NDArray[np.bool_]
    ) -> None:
        due = [entry for entry in self._late_obstacles if entry[0] <= time + 1e-9]
        for entry in due:
            _, row, state = entry
            frame[row], present[row] = state, True
            self._late_obstacles.remove(entry)

    def _look_around(self, k: int, time: float) -> None:
        """Finds contacts and ends, and whether the episode is over."""
        world, team = self._world, self._team
        count = find_contacts(
            world.states[k], world.sizes, world.present[k], team.active, self._seen, self._found
        )
        ended = team.follow(k, time, self._dt, world)
        if count:
            for i, j in self._found[:count].tolist():
                self._contacts.append(Contact(step=k, ego=i, other=j))
                self._end(i, TerminalEvent.COLLISION, k)
        if ended:
            for m, code in enumerate(team.ends.tolist()):
                event = ENDS[code]
                if event is not None:
                    self._end(m, event, k)
        over = time >= self.plan.max_sim_time - 1e-9
        if over:
            for m in range(len(self.plan.egos)):
                if team.endings[m].event is None:
                    self._end(m, TerminalEvent.TIME_LIMIT, k)
        self.done = over or team.going == 0

    def _end(self, m: int, event: TerminalEvent, step: int) -> None:
        if self._team.modes[m] == CommandMode.EXTERNAL:
            self._traffic.take_back(m, on_road=bool(self._world.present[step, m]))
        self._team.end(m, event, step)

    def look(self) -> Look:
        """Gives the episode as it is now."""
        frame, present = self._world.states[self._k], self._world.present[self._k]
        return Look(
            time=self.time,
            step=self._k,
            actors=tuple(
                ActorState(
                    id=actor.id,
                    role=actor.role,
                    model=actor.model,
                    x=float(frame[actor.row, Col.X]),
                    y=float(frame[actor.row, Col.Y]),
                    yaw=float(frame[actor.row, Col.YAW]),
                    speed=float(np.hypot(frame[actor.row, Col.VX], frame[actor.row, Col.VY])),
                    length=actor.length,
                    width=actor.width,
                )
                for actor in self._world.actors
                if present[actor.row]
            ),
            done=self.done,
        )

    def add_vehicle(self, npc: NpcVehicle) -> None:
        """Adds an NPC vehicle during the run; it starts at its start time, at the earliest now."""
        self._check_new(npc.id)
        if npc.behavior is NpcBehavior.SUMO:
            plan = plan_driven(npc, self.plan.network)
            row = len(self._world.actors)
            size = plan.model
            self._join(
                Actor(
                    row=row,
                    id=npc.id,
                    role=Role.NPC_VEHICLE,
                    model=size.name,
                    length=size.length,
                    width=size.width,
                )
            )
            self._traffic.add_driven(row, plan)
            return
        self._add_follower(plan_npc(npc, self.plan.network, self.plan.weather.friction))

    def add_walker(self, walker: NpcWalker) -> None:
        """Adds a walker during the run; it starts at its start time, at the earliest now."""
        self._check_new(walker.id)
        self._add_follower(plan_walker(walker, self.plan.network))

    def _add_follower(self, plan: FollowerPlan) -> None:
        actor = _follower_actor(plan, len(self._world.actors))
        self._join(actor)
        append_follower(self._followers, plan, actor.row)
        self._traffic.add_body(_body(actor, plan.edges, on_lanes=plan.on_lanes))

    def _check_new(self, actor_id: str) -> None:
        if self.done:
            raise SimulatorError("the episode has ended: nobody can join it any more")
        if any(actor.id == actor_id for actor in self._world.actors):
            raise SimulatorError(f"there is an actor {actor_id!r} already: choose another id")

    def _join(self, actor: Actor) -> None:
        self._world.add_actor(actor)
        self._static = np.append(self._static, False)
        self._seen = np.concatenate(
            (self._seen, np.zeros((len(self._seen), 1), dtype=np.bool_)), axis=1
        )

    def finish(self) -> Trace:
        """Gives the trace of all steps so far."""
        return assemble_trace(
            self.plan,
            self._world,
            Record(
                last_step=self._k,
                endings=self._team.endings,
                contacts=self._contacts,
                log_names=self._team.log_names,
                logs=self._team.logs,
                privileged=self._privileged,
            ),
        )


def _follower_actor(plan: FollowerPlan, row: int) -> Actor:
    return Actor(
        row=row,
        id=plan.id,
        role=plan.role,
        model=plan.model.name,
        length=plan.model.length,
        width=plan.model.width,
    )


def _body(actor: Actor, edges: Sequence[str], *, on_lanes: bool) -> Body:
    return Body(
        row=actor.row,
        id=actor.id,
        edges=tuple(edges),
        on_lanes=on_lanes,
        is_walker=actor.role is Role.NPC_WALKER,
        length=actor.length,
        width=actor.width,
    )
