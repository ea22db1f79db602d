"""The egos of an episode: their bodies, observations, decisions and endings."""

from __future__ import annotations

import traceback
from collections.abc import Mapping, Sequence
from copy import deepcopy
from time import perf_counter_ns

import numpy as np
from numpy.typing import NDArray

from drivora_service.agents.interface import (
    Agent,
    AgentContext,
    Control,
    Observation,
    TrajectoryCol,
    TrajectoryControl,
)
from drivora_service.agents.log import AgentLog
from drivora_service.agents.sumo_driver import SumoDriver
from drivora_service.compilation import specialize
from drivora_service.errors import AgentError
from drivora_service.geometry.array_shapes import FloatArray, IntArray
from drivora_service.observations.trace import Col, Light, TerminalEvent
from drivora_service.scenario.model import VehicleDynamics
from drivora_service.scenario.weather import WeatherEffects
from drivora_service.simulation.motion.route_tracking import Progress
from drivora_service.simulation.motion.vehicle_commands import write_command
from drivora_service.simulation.motion.vehicle_dynamics import Body, CommandMode, PoseCommand
from drivora_service.simulation.perception.ego_perception import (
    Draw,
    Seen,
    empty_seen,
    perceive,
)
from drivora_service.simulation.perception.sensor_noise import SensorNoise, ego_seeds, is_noisy
from drivora_service.simulation.plans.episode_plan import EpisodePlan
from drivora_service.simulation.plans.plan_arrays import (
    first_progress,
    lay_routes,
    privileged_senses,
    senses_of,
    vehicle_limits,
)
from drivora_service.simulation.run_phase import SETTING_UP, BoardCell, RunPhase
from drivora_service.simulation.trace_assembly import Ending
from drivora_service.simulation.world import World

# Enum attributes are slow to look up: the step loop uses plain values.
_IN_AGENT, _SIMULATING = int(RunPhase.IN_AGENT), int(RunPhase.SIMULATING)
_PHASE, _STEP, _EGO = int(BoardCell.PHASE), int(BoardCell.STEP), int(BoardCell.EGO)
_ROUTE_S, _SPEED_LIMIT = int(Progress.ROUTE_S), int(Progress.SPEED_LIMIT)
_SPEED, _STEER = int(Body.SPEED), int(Body.STEER)
_LIGHTS = tuple(Light)
_PLAN_PERIOD = 0.1
"""Seconds between two planned paths that are recorded."""


class EgoTeam:
    """All egos. Rows of the arrays are egos, as in the world.

    Attributes:
        bodies: (M, 10), columns ``dynamics.Body``.
        limits: (M, 8), columns ``dynamics.Limit``.
        modes: (M,) ``CommandMode``.
        commands: (M, 4), columns ``DriveCommand`` or ``PoseCommand``, by mode.
        active: (M,) egos whose part has begun and not ended.
        in_world: (M,) egos that are on the road.
        routes: The routes as arrays for the kernels.
        progress: (M, 11), columns ``route_tracking.Progress``.
        ends: (M,) index into ``route_tracking.ENDS`` of the event that ended an ego's part in the
            last frame.
        going: Number of egos whose parts have not ended.
        endings: End of each ego's part.
        agent_ns: Wall nanoseconds that each ego's agent has spent in ``run_step``.
        logs: Agent logs.
        log_names: Names of all numeric log columns.
    """

    def __init__(
        self,
        plan: EpisodePlan,
        agents: Sequence[Agent | SumoDriver],
        privileged: Sequence[bool],
        cells: NDArray[np.int64],
    ) -> None:
        count = len(plan.egos)
        self._plan = plan
        self.agents = list(agents)
        self._cells = cells
        self.bodies: FloatArray = np.zeros((count, len(Body)))
        self.bodies[:, : Body.YAW + 1] = [ego.start for ego in plan.egos]
        self.bodies[:, Body.HEIGHT] = [ego.heights[0] for ego in plan.egos]
        self.limits = vehicle_limits(
            [ego.model for ego in plan.egos],
            [ego.ego.dynamics is VehicleDynamics.DYNAMIC for ego in plan.egos],
        )
        self.modes: IntArray = np.full(count, int(CommandMode.HOLD), dtype=np.int64)
        self.commands = np.zeros((count, len(PoseCommand)))
        self.active = np.zeros(count, dtype=np.bool_)
        self.in_world = np.ones(count, dtype=np.bool_)
        self.endings = [Ending() for _ in range(count)]
        self.ends: IntArray = np.zeros(count, dtype=np.int64)
        self.going = count
        self.agent_ns = [0] * count
        self.routes = lay_routes(plan.egos, plan.programs)
        self.progress = first_progress(plan.egos, plan.stuck_after)
        self._privileged = tuple(privileged)
        self.set_weather(plan.weather)
        seeds = ego_seeds(plan.scenario.seed, count)
        self._noise = [SensorNoise(seed) for seed in seeds[:count]]
        self.logs = [AgentLog() for _ in range(count)]
        for log in self.logs:
            log.plan_every = max(round(_PLAN_PERIOD / plan.scenario.step_length), 1)
        for m, agent in enumerate(self.agents):
            if not isinstance(agent, SumoDriver):
                self._set_up(m, agent, int(seeds[count + m].generate_state(1)[0]))
        names = dict.fromkeys(name for log in self.logs for name in log.names)
        self.log_names = tuple(names)
        # Rows as views, which take time to make.
        self._rows = tuple(
            zip(self.bodies, self.progress[:, _ROUTE_S : _SPEED_LIMIT + 1], strict=True)
        )
        self._asked = tuple(
            (m, agent, plan.egos[m], self.logs[m], self._columns_of(self.logs[m]), command)
            for m, (agent, command) in enumerate(zip(self.agents, self.commands, strict=True))
            if not isinstance(agent, SumoDriver)
        )
        self._step_length = plan.scenario.step_length
        self._last_start = max(ego.ego.start_time for ego in plan.egos)
        self._observations: list[Observation] = []
        self._buffers: list[Seen] = []
        self._views: list[Seen] = []
        self._draws = np.zeros((0, len(Draw)))
        self._sights: IntArray = np.zeros(0, dtype=np.int64)
        self._perceive = perceive

    def set_weather(self, weather: WeatherEffects) -> None:
        """Has the egos perceive in a weather from now on."""
        usual = senses_of(weather, self._plan.scenario.step_length)
        self._senses = [privileged_senses() if sees_all else usual for sees_all in self._privileged]
        self._is_noisy = is_noisy(usual)

    def _set_up(self, m: int, agent: Agent, seed: int) -> None:
        plan = self._plan.egos[m]
        context = AgentContext(
            ego_id=plan.ego.id,
            model=plan.model,
            network=self._plan.network,
            route=plan.route,
            step_length=self._plan.scenario.step_length,
            friction=self._plan.weather.friction,
            seed=seed,
            parameters=deepcopy(plan.ego.agent.parameters),
            log=self.logs[m],
        )
        # Distinguishes this call from the first step, even without a reading of the cells between.
        cells = self._cells
        cells[_STEP], cells[_EGO], cells[_PHASE] = SETTING_UP, m, RunPhase.IN_AGENT
        try:
            agent.setup_env(context)
        except (Exception, SystemExit) as error:
            raise _make_agent_error(plan.ego.id, plan.ego.agent.name, "setup_env", error) from error
        cells[_PHASE], cells[_STEP] = RunPhase.SIMULATING, 0

    def _columns_of(self, log: AgentLog) -> IntArray | slice:
        """Returns the indices of a log's columns among all; if possible as a slice, for speed."""
        columns = [self.log_names.index(name) for name in log.names]
        if columns and columns == list(range(columns[0], columns[0] + len(columns))):
            return slice(columns[0], columns[0] + len(columns))
        return np.array(columns, dtype=np.int64)

    def _make_room(self, count: int) -> None:
        """Resizes the observation buffers to a world of ``count`` rows."""
        self._draws = np.zeros((count, len(Draw)))
        self._sights = np.zeros(count, dtype=np.int64)
        self._buffers = []
        self._views = []
        self._observations = []
        for _ in range(len(self.agents)):
            seen = empty_seen(count)
            self._buffers.append(seen)
            self._views.append(seen)
            self._observations.append(
                Observation(
                    ego=np.full(len(Col), np.nan),
                    objects=seen.states,
                    object_sizes=seen.sizes,
                    object_kinds=seen.kinds,
                    object_ids=seen.ids,
                )
            )

    def start_due(self, time: float) -> list[int]:
        """Starts the egos whose start time has come; returns their rows."""
        if self._last_start < time - 1.0:
            return []
        started = []
        for m, ego in enumerate(self._plan.egos):
            waiting = not self.active[m] and self.endings[m].event is None
            if waiting and time >= ego.ego.start_time - 1e-9:
                self.active[m] = True
                self.bodies[m, Body.SPEED] = ego.ego.initial_speed
                started.append(m)
        return started

    def decide(
        self, step: int, time: float, world: World, controls: Mapping[str, Control] | None
    ) -> None:
        """Asks every active ego's agent, or takes its control from ``controls`` by ego id."""
        if len(self._draws) != len(world.actors):
            self._make_room(len(world.actors))
        cells, active = self._cells, self.active
        for m, agent, ego, log, columns, command in self._asked:
            if not active[m]:
                continue
            control = None if controls is None else controls.get(ego.ego.id)
            if control is None:
                observation = self._observe(m, step, time, world)
                log.step = step
                cells[_STEP], cells[_EGO], cells[_PHASE] = step, m, _IN_AGENT
                try:
                    begun = perf_counter_ns()
                    control = agent.run_step(observation)
                    self.agent_ns[m] += perf_counter_ns() - begun
                    if log.names:
                        world.logs[step, m, columns] = log.row
                except (Exception, SystemExit) as error:
                    where = f"run_step at {time:.2f} s"
                    raise _make_agent_error(ego.ego.id, ego.ego.agent.name, where, error) from error
                cells[_PHASE] = _SIMULATING
            try:
                self.modes[m] = write_command(control, ego.model, self._step_length, command)
            except (AgentError, ArithmeticError, TypeError, ValueError) as error:
                raise _make_control_error(ego.ego.id, ego.ego.agent.name, time, error) from error
            if isinstance(control, TrajectoryControl):
                log.plan(np.asarray(control.points)[:, TrajectoryCol.X : TrajectoryCol.Y + 1])

    def _observe(self, m: int, step: int, time: float, world: World) -> Observation:
        if self._is_noisy:
            self._noise[m].draw(self._draws)
        seen = self._buffers[m]
        count = self._perceive(
            m, step, world.frames, world.heights, world.kinds, self._senses[m], self._draws, seen,
            self._sights,
        )  # fmt: skip
        if self._perceive is perceive:
            # Later calls have arguments of the same types.
            self._perceive = specialize(perceive)
        views = self._views[m]
        if count != len(views.ids):
            views = self._views[m] = Seen(
                states=seen.states[:count],
                sizes=seen.sizes[:count],
                kinds=seen.kinds[:count],
                ids=seen.ids[:count],
            )
        observation = self._observations[m]
        observation.objects, observation.object_sizes = views.states, views.sizes
        observation.object_kinds, observation.object_ids = views.kinds, views.ids
        observation.time = time
        observation.step = step
        # A copy: the frames are the evidence, and a view would let an agent write into them.
        observation.ego = world.states[step, m].copy()
        body, progress = self._rows[m]
        observation.speed, _, _, observation.steer, observation.acceleration = body[
            _SPEED : _STEER + 2
        ].tolist()
        (
            observation.route_s,
            observation.route_lateral,
            light,
            protected,
            observation.light_distance,
            observation.speed_limit,
        ) = progress.tolist()
        observation.light = _LIGHTS[int(light)]
        observation.light_protected = protected > 0.0
        return observation

    def end(self, m: int, event: TerminalEvent, step: int) -> None:
        """Ends an ego's part: an ego that arrived leaves, others stay where they are."""
        if self.endings[m].event is None:
            self.endings[m].event = event
            self.endings[m].step = step
            self.going -= 1
        self.active[m] = False
        self.modes[m] = CommandMode.HOLD
        if event is TerminalEvent.ARRIVED:
            self.in_world[m] = False


def _make_control_error(ego: str, agent: str, time: float, error: Exception) -> AgentError:
    return AgentError(
        f"control of ego {ego!r} by agent {agent!r} at {time:.2f} s: {error}",
        cause="agent_invalid_control",
        log="".join(traceback.format_exception(error))[-4000:],
    )


def _make_agent_error(ego: str, agent: str, where: str, error: BaseException) -> AgentError:
    if isinstance(error, AgentError):
        return error
    return AgentError(
        f"agent {agent!r} of ego {ego!r} raised {type(error).__name__} in {where}: {error}",
        cause="agent_raised",
        log="".join(traceback.format_exception(error))[-4000:],
    )
