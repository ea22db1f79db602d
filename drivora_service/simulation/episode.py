"""An episode: reset, steps until its end, inspection in between, and its trace.

Row ``k`` of the world is the state at ``k * step_length`` seconds. A step lets every agent decide
on row ``k``, moves what the service moves to row ``k + 1``, sends that to SUMO, lets SUMO move its
own vehicles, and then detects contacts and ended parts.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from drivora_service.agents.interface import Agent, Control
from drivora_service.agents.sumo_driver import SumoDriver, common_lane_change_model
from drivora_service.compilation import specialize
from drivora_service.errors import SimulatorError
from drivora_service.observations.trace import Actor, Col, Contact, Role, TerminalEvent, Trace
from drivora_service.scenario.model import (
    NpcBehavior,
    NpcVehicle,
    NpcWalker,
    Scenario,
    Weather,
)
from drivora_service.scenario.weather import WeatherEffects, weather_effects
from drivora_service.simulation.ego_team import EgoTeam
from drivora_service.simulation.episode_changes import (
    Changes,
    Joining,
    change_step,
    changes_anything,
)
from drivora_service.simulation.look import Frames, Look, frames_of, look_at
from drivora_service.simulation.motion.route_tracking import ENDS, EgoProgress
from drivora_service.simulation.motion.step_kernels import (
    Surroundings,
    finish_frame,
    make_frame,
    take_over_driven,
    write_velocity,
)
from drivora_service.simulation.motion.vehicle_dynamics import CommandMode, EgoBodies
from drivora_service.simulation.plans.casting import cast_actors, follower_actor, follower_body
from drivora_service.simulation.plans.episode_plan import DrivenPlan, EpisodePlan, FollowerPlan
from drivora_service.simulation.plans.plan_arrays import (
    append_follower,
    lay_followers,
    lay_ground,
    lay_obstacles,
)
from drivora_service.simulation.plans.planning_npcs import plan_driven, plan_npc, plan_walker
from drivora_service.simulation.run_phase import BoardCell
from drivora_service.simulation.sumo import SumoWorld
from drivora_service.simulation.trace_assembly import Record, assemble_trace
from drivora_service.simulation.traffic import background
from drivora_service.simulation.traffic.background_vehicles import BackgroundVehicles
from drivora_service.simulation.traffic.holding import Holding, look_ahead_is_bounded
from drivora_service.simulation.traffic.stand_ins import StandIns
from drivora_service.simulation.traffic.sumo_patches import SumoPatches
from drivora_service.simulation.traffic.sumo_traffic import Traffic
from drivora_service.simulation.world import World

_ROOM_FOR_CONTACTS = 64
"""Contacts that may begin in one step. One that finds no room is found in the next step, unless
another contact has ended the part of its ego."""
_STEP = int(BoardCell.STEP)


class Episode:
    """A running episode. A process runs one at a time, since it can hold only one SUMO.

    A complete run is a loop::

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
        mirrored: bool = False,
        holding: bool = False,
    ) -> None:
        """Sets up the agents and creates row 0.

        Args:
            plan: Plan of the episode.
            agents: An agent for every ego, in order.
            privileged: Whether each agent bypasses the perception model.
            cells: ``BoardCell`` progress integers to keep current (``worker.progress_board``).
            mirrored: Whether SUMO has every actor at its place after every step, for agents and
                callers that read it. Otherwise it has only while it drives vehicles, and after
                ``catch_up_sumo``. Traces do not depend on it.
            holding: Whether SUMO need not be told of actors far from what it drives
                (``simulation.traffic.holding``), for runs that are only stepped: nothing reads
                SUMO, and no actor is added. Traces do not depend on it. Without effect where
                the scenario has changes during the run.

        Raises:
            AgentError: If an agent fails in ``setup_env``, or two of SUMO's drivers need different
                lane-change models.
            SimulatorError: If SUMO refuses the network or an actor; where SUMO has not been needed
                until then, ``step`` or ``catch_up_sumo`` raises it.
        """
        self.plan = plan
        self.done = False
        self._dt = plan.scenario.step_length
        self._k = 0
        self._has_sumo_drivers = any(isinstance(agent, SumoDriver) for agent in agents)
        lane_change_model = common_lane_change_model(agents)
        self._privileged = tuple(privileged) or (False,) * len(agents)
        self._cells = np.zeros(len(BoardCell), dtype=np.int64) if cells is None else cells
        self._team = EgoTeam(plan, agents, self._privileged, self._cells)
        self._changes = Changes(plan.scenario)
        self._weather = plan.weather
        self._weather_changes: list[tuple[int, WeatherEffects]] = []
        # Actors that join are told at once.
        self._holding = holding = holding and not changes_anything(plan.scenario)
        self._contacts: list[Contact] = []
        self._found = np.zeros((_ROOM_FOR_CONTACTS, 2), dtype=np.int64)
        cast = cast_actors(plan)
        actors = list(cast.actors)
        self._world = World(
            actors,
            cast.heights,
            len(plan.egos),
            len(self._team.log_names),
            expected_rows=int(plan.max_sim_time / self._dt) + 2,
        )
        self._followers = lay_followers(plan.followers, cast.follower_rows)
        self._static = lay_obstacles(plan.obstacles, cast.obstacle_rows, len(actors))
        self._ground = lay_ground(plan.weather, plan.patch_array)
        self._seen = np.zeros((len(plan.egos), len(actors)), dtype=np.bool_)
        sublanes = lane_change_model == "SL2015"
        self._sumo = SumoWorld(
            plan.network.path,
            step_length=self._dt,
            seed=plan.scenario.seed,
            slippery=plan.weather.friction < 1.0,
            sublanes=sublanes,
        )
        self._traffic = Traffic(
            self._sumo,
            StandIns(self._sumo, plan.network, self._dt, sublanes=sublanes),
            self._world,
            cast.bodies,
            lane_change_model=lane_change_model,
            sublanes=sublanes,
            open_sumo=self._open_sumo,
            mirrored=mirrored,
            holding=(
                partial(Holding, plan.network, plan.weather.friction)
                # On slippery places SUMO's vehicles need the room of farther actors than elsewhere.
                if holding
                and not (mirrored or sublanes or plan.patches)
                and look_ahead_is_bounded(agents)
                else None
            ),
            patches=(
                SumoPatches(self._sumo, plan.weather.friction, plan.patch_array)
                if plan.patches
                else None
            ),
        )
        for m, agent in enumerate(agents):
            if isinstance(agent, SumoDriver):
                self._traffic.reserve(m)
        self._announce(actors)
        self._bind()
        self._settle()
        self._make_kernel, self._finish_kernel = make_frame, finish_frame
        self._make_first_frame()
        # Later frames have arguments of the same types.
        self._make_kernel, self._finish_kernel = specialize(make_frame), specialize(finish_frame)

    @property
    def time(self) -> float:
        """Seconds of simulation."""
        return self._k * self._dt

    def agent_seconds(self) -> dict[str, float]:
        """Returns by ego the wall seconds that its agent has spent in ``run_step``.

        Egos that SUMO drives are left out: they have no agent.
        """
        asked = zip(self.plan.egos, self._team.agents, self._team.agent_ns, strict=True)
        return {
            ego.ego.id: 1e-9 * spent
            for ego, agent, spent in asked
            if not isinstance(agent, SumoDriver)
        }

    def _open_sumo(self) -> None:
        plan, sumo = self.plan, self._sumo
        sumo.open()
        if plan.weather.friction < 1.0:
            edges = [edge for edge in plan.network.edge_lanes if not edge.startswith(":")]
            sumo.set_friction(edges, plan.weather.friction)
        # SUMO switches at the beginning of a step: the signals after the step that creates row 0
        # are those of the programmes at time 0.
        sumo.set_programs(plan.programs, 0.0)

    def _announce(self, actors: Sequence[Actor]) -> None:
        """Announces to the traffic the actors that SUMO will drive."""
        rows = {actor.id: actor.row for actor in actors}
        for driven in self.plan.driven:
            self._traffic.add_driven(rows[driven.id], driven)
        flow = self.plan.scenario.background_traffic
        if flow is None or not flow.count:
            return
        # 1 is the stream of background traffic; 2 is that of the noise of sensors.
        rng = np.random.default_rng(np.random.SeedSequence([self.plan.scenario.seed, 1]))
        self._traffic.add_background(
            BackgroundVehicles(
                background.Wanderers(
                    self.plan.network, self.plan.scenario.map_region.region_segment, rng
                ),
                [(actor.row, actor.id) for actor in actors if actor.role is Role.BACKGROUND],
                clear=np.concatenate(
                    [background.clearance_points(*ego.start[:2]) for ego in self.plan.egos]
                ),
                start_time=flow.start_time,
                driver=self._traffic.driver,
            )
        )

    def _bind(self) -> None:
        """Collects the constant arguments of the step kernels; repeated when the world grows."""
        world, team, traffic = self._world, self._team, self._traffic
        bodies = EgoBodies(
            bodies=team.bodies,
            limits=team.limits,
            modes=team.modes,
            commands=team.commands,
            in_world=team.in_world,
            values=world.ego_values,
        )
        progress = EgoProgress(
            bodies=team.bodies,
            active=team.active,
            progress=team.progress,
            values=world.ego_values,
            lights=world.ego_lights,
            ends=team.ends,
        )
        around = Surroundings(self._dt, self._ground, self._static)
        self._make_arguments = (around, world.frames, bodies, self._followers, traffic.moved)
        self._finish_arguments = (
            self._dt, world.frames, progress, team.routes, self._seen, self._found,
        )  # fmt: skip

    def _settle(self) -> None:
        """Notes the step before which something besides the step itself is to be done."""
        self._pauses_at = min(self._world.capacity - 1, self._changes.next_step)

    def _make_first_frame(self) -> None:
        self._team.start_due(0.0)
        # No actor is present yet in row 1, which serves as the frame before the first.
        self._make_frame(1, 0, 0.0)
        self._hand_over_started(range(len(self.plan.egos)))
        self._finish_frame(1, 0, 0.0)

    def _make_frame(self, before: int, after: int, time: float) -> None:
        """Moves egos and followers, then SUMO's own vehicles."""
        changes = self._make_kernel(
            before, after, time, self._traffic.keeps_up, *self._make_arguments
        )
        self._traffic.step(after, time, changes)

    def _hand_over_started(self, rows: Sequence[int]) -> None:
        for m in rows:
            agent = self._team.agents[m]
            if self._team.active[m] and isinstance(agent, SumoDriver):
                self._traffic.hand_over(m, self.plan.egos[m].ego.initial_speed, agent.type_id)
                self._team.modes[m] = CommandMode.EXTERNAL

    def step(self, controls: Mapping[str, Control] | None = None) -> bool:
        """Simulates one step.

        Args:
            controls: Controls by ego id that replace those of the ego's agent.

        Returns:
            Whether the episode has ended.

        Raises:
            AgentError: If an agent raises or its answer is not a control.
            SimulatorError: If the episode has ended already, or ``controls`` names an unknown ego.
        """
        if self.done:
            raise SimulatorError("the episode has ended: create a new one")
        if controls:
            self._check_egos(controls)
        world, k = self._world, self._k
        if k >= self._pauses_at:
            self._pause(k)
        time, next_time = k * self._dt, (k + 1) * self._dt
        self._cells[_STEP] = k
        self._team.decide(k, time, world, controls)
        self._make_frame(k, k + 1, next_time)
        self._k = k + 1
        # Before the frame is completed, since an ego is tracked from the first frame of its part
        # on.
        started = self._team.start_due(next_time)
        if started:
            for m in started:
                write_velocity(self._team.bodies[m], world.states[k + 1, m])
            self._hand_over_started(started)
        self._finish_frame(k, k + 1, next_time)
        for m in started:
            # Its standstill before is not part of its drive: its rates are 0 as on first
            # appearance.
            world.states[k + 1, m, Col.AX : Col.YAW_RATE + 1] = 0.0
        return self.done

    def _pause(self, k: int) -> None:
        """Makes room for the next frame, and the changes that are due."""
        if k + 1 >= self._world.capacity:
            self._world.grow()
        if k >= self._changes.next_step:
            due = self._changes.take(k)
            if due.weather is not None:
                self._set_weather(due.weather, k)
            for actor in due.joining:
                self._let_join(actor)
        self._bind()
        self._settle()

    def _set_weather(self, weather: Weather, k: int) -> None:
        """Changes what the weather acts on: vehicles that the service moves, and perception.

        SUMO's drivers keep to the friction of the beginning, for which they are set up.
        """
        self._weather = weather_effects(weather)
        self._weather_changes.append((k, self._weather))
        self._ground = lay_ground(self._weather, self.plan.patch_array)
        self._team.set_weather(self._weather)

    def _check_egos(self, ids: Iterable[str]) -> None:
        egos = [ego.ego.id for ego in self.plan.egos]
        for ego in ids:
            if ego not in egos:
                known = ", ".join(egos)
                raise SimulatorError(f"unknown ego {ego!r} to control; known: {known}")

    def _finish_frame(self, before: int, k: int, time: float) -> None:
        """Finds contacts and ends, and whether the episode is over."""
        team = self._team
        count, ended = self._finish_kernel(before, k, time, *self._finish_arguments)
        if k and self._has_sumo_drivers:
            driven = team.modes == CommandMode.EXTERNAL
            take_over_driven(team.bodies, driven, self._world.states[k], self._dt)
        # The first end of an ego stands: a collision before an arrival in the same step, and both
        # before the limit of time.
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
        self._traffic.fix(m)
        self._team.end(m, event, step)

    def look(self) -> Look:
        """Returns the episode in its present state."""
        return look_at(self._world, self._k, self.time, done=self.done)

    @property
    def actors(self) -> tuple[Actor, ...]:
        """The actors so far, in the order of their rows."""
        return tuple(self._world.actors)

    def frames(self, first: int) -> Frames:
        """Returns the frames from a row of the trace to the present one."""
        return frames_of(self._world, first, self._k)

    @property
    def row(self) -> int:
        """Row of the trace with the present frame."""
        return self._k

    def ending(self, ego: int) -> TerminalEvent | None:
        """Returns the event that has ended the part of an ego, by its row; ``None``: none yet."""
        return self._team.endings[ego].event

    @property
    def weather(self) -> Weather:
        """The present weather; a change counts from the step that makes it."""
        changes = self.scenario.weather_changes
        due = [c for c in changes if change_step(c.time, self._dt) <= self._k]
        return due[-1].weather if due else self.plan.scenario.weather

    def catch_up_sumo(self) -> None:
        """Has SUMO hold every actor at its present place, for callers that read it.

        Raises:
            SimulatorError: If SUMO refuses the network or an actor, or the episode was created with
                ``holding``.
        """
        if self._holding:
            raise SimulatorError(
                "SUMO is not told of all actors: create the episode without `holding`"
            )
        self._traffic.catch_up()

    @property
    def scenario(self) -> Scenario:
        """The scenario with all that was added during the run: an episode of it is this run."""
        return self._changes.scenario

    def add_vehicle(self, npc: NpcVehicle) -> None:
        """Adds an NPC vehicle, which joins at its start time, at the earliest in the next step."""
        self._check_new(npc.id)
        # Refuses now what could not join later.
        if npc.behavior is NpcBehavior.SUMO:
            plan_driven(npc, self.plan.network)
        else:
            self._plan_npc(npc)
        self._changes.add(npc, self._k)
        self._settle()

    def add_walker(self, walker: NpcWalker) -> None:
        """Adds a walker, which joins at its start time, at the earliest in the next step."""
        self._check_new(walker.id)
        plan_walker(walker, self.plan.network)
        self._changes.add(walker, self._k)
        self._settle()

    def change_weather(self, weather: Weather) -> None:
        """Changes the weather from the next step on."""
        self._check_open()
        self._changes.set_weather(weather, self._k)
        self._settle()

    def _let_join(self, actor: Joining) -> None:
        network = self.plan.network
        if isinstance(actor, NpcWalker):
            self._add_follower(plan_walker(actor, network))
        elif actor.behavior is NpcBehavior.SUMO:
            self._add_driven(plan_driven(actor, network))
        else:
            self._add_follower(self._plan_npc(actor))

    def _plan_npc(self, npc: NpcVehicle) -> FollowerPlan:
        plan = self.plan
        return plan_npc(npc, plan.network, self._weather.friction, plan.patches)

    def _add_driven(self, plan: DrivenPlan) -> None:
        row, size = len(self._world.actors), plan.model
        self._join(
            Actor(
                row=row,
                id=plan.id,
                role=Role.NPC_VEHICLE,
                model=size.name,
                length=size.length,
                width=size.width,
            ),
            size.height,
        )
        self._traffic.add_driven(row, plan)

    def _add_follower(self, plan: FollowerPlan) -> None:
        actor = follower_actor(plan, len(self._world.actors))
        self._followers = append_follower(self._followers, plan, actor.row)
        self._traffic.add_body(follower_body(plan, actor))
        self._join(actor, plan.model.height)

    def _check_new(self, actor_id: str) -> None:
        self._check_open()
        known = (actor.id == actor_id for actor in self._world.actors)
        if any(known) or actor_id in self._changes.ids:
            raise SimulatorError(f"the actor id {actor_id!r} is taken: choose another id")

    def _check_open(self) -> None:
        if self.done:
            raise SimulatorError("the episode has ended: nothing can be added or changed")
        if self._holding:
            raise SimulatorError(
                "nothing can be added or changed with `holding`: create the episode without it"
            )

    def _join(self, actor: Actor, height: float) -> None:
        self._world.add_actor(actor, height)
        nowhere = np.full((1, self._static.shape[1]), np.inf)
        self._static = np.concatenate((self._static, nowhere))
        self._seen = np.concatenate(
            (self._seen, np.zeros((len(self._seen), 1), dtype=np.bool_)), axis=1
        )
        self._traffic.make_room()

    def finish(self) -> Trace:
        """Returns the trace of all steps so far."""
        return assemble_trace(
            replace(self.plan, scenario=self.scenario),
            self._world,
            Record(
                last_step=self._k,
                is_over=self.done,
                endings=self._team.endings,
                contacts=self._contacts,
                log_names=self._team.log_names,
                logs=self._team.logs,
                privileged=self._privileged,
                weather_changes=self._weather_changes,
            ),
        )
