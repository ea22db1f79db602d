"""Assembly of an episode's trace from its frames, outside the step loop."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from drivora_service.agents.log import AgentLog
from drivora_service.geometry.array_shapes import FloatArray, IntArray
from drivora_service.networks.projection import project_points
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.observations.recorded_conditions import (
    CHANGES_KEY,
    FRICTION,
    PATCHES_KEY,
    PERCEPTION_RANGE,
)
from drivora_service.observations.trace import (
    Col,
    Contact,
    EgoCol,
    EgoRoute,
    LogEvent,
    PlannedPath,
    PoseCol,
    TerminalEvent,
    Trace,
)
from drivora_service.scenario.canonical import scenario_sha256
from drivora_service.scenario.model import EgoVehicle
from drivora_service.scenario.weather import WeatherEffects
from drivora_service.simulation.plans.episode_plan import EpisodePlan
from drivora_service.simulation.world import World

_Item = TypeVar("_Item", bound=np.generic)


@dataclass(slots=True, kw_only=True)
class Ending:
    """The end of an ego's part; empty until then."""

    event: TerminalEvent | None = None
    step: int = -1


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Record:
    """The data of an episode besides the frames.

    Attributes:
        last_step: Row of the last frame.
        weather_changes: Steps of the weather's changes so far, with the effects from then on.
        is_over: Whether no frame will be written any more; else the trace gets copies.
    """

    last_step: int
    is_over: bool
    endings: Sequence[Ending]
    contacts: Sequence[Contact]
    log_names: tuple[str, ...]
    logs: Sequence[AgentLog]
    privileged: tuple[bool, ...]
    weather_changes: Sequence[tuple[int, WeatherEffects]] = ()
    versions: dict[str, str] = field(default_factory=dict)


def assemble_trace(plan: EpisodePlan, world: World, record: Record) -> Trace:
    """Returns the trace of an episode so far; of an unfinished one, with copies of its frames.

    What the step loop does not need is computed here for all rows at once: the lanes of the egos
    and the states of the signals.
    """
    rows = record.last_step + 1
    dt = plan.scenario.step_length
    times: FloatArray = np.arange(rows, dtype=np.float64) * dt
    # A copy, always: the columns of the lane are filled in here.
    values = world.ego_values[:rows].copy()
    lanes = np.full((rows, world.ego_count), -1, dtype=np.int32)
    for m in range(world.ego_count):
        # An ego that has arrived leaves the world, and has no lane from then on.
        here = np.flatnonzero(world.present[:rows, m])
        states = world.states[here, m]
        found = project_points(plan.network, states[:, :2].copy(), states[:, Col.YAW].copy())
        on_lane = found.lane >= 0
        lanes[here, m] = found.lane
        # Off all lanes the index is -1, which takes any lane's limit: it is discarded.
        limits = _speed_limits(plan.network)
        values[here, m, EgoCol.SPEED_LIMIT] = np.where(on_lane, limits[found.lane], np.nan)
        values[here, m, EgoCol.LANE_LATERAL] = np.where(on_lane, found.lateral, np.nan)
        values[here, m, EgoCol.LANE_HEADING] = np.where(on_lane, found.heading, np.nan)

    def copy_unless_over(frames: NDArray[_Item]) -> NDArray[_Item]:
        # The frames are most of the memory of a run: copied only if a step may follow, which writes
        # the commands of the last row too.
        return frames if record.is_over else frames.copy()

    names: list[str] = []
    light_states = np.zeros((rows, len(plan.programs)), dtype=np.int32)
    stages: dict[tuple[float, bytes], IntArray] = {}
    for i, program in enumerate(plan.programs):
        # Most programmes of a network have the same cycle.
        cycle = (program.offset, program.ends.tobytes())
        if cycle not in stages:
            stages[cycle] = program.phase_at(times)
        # From the stages of this programme to the names of all: programmes share most states.
        index = []
        for phase in program.phases:
            if phase.state not in names:
                names.append(phase.state)
            index.append(names.index(phase.state))
        light_states[:, i] = np.array(index, dtype=np.int32)[stages[cycle]]
    return Trace(
        network=plan.network.name,
        network_sha256=plan.network.sha256,
        scenario_sha256=scenario_sha256(plan.scenario),
        step_length=dt,
        times=times,
        actors=tuple(world.actors),
        states=copy_unless_over(world.states[:rows]),
        present=copy_unless_over(world.present[:rows]),
        ego_values=values,
        ego_lanes=lanes,
        ego_lights=copy_unless_over(world.ego_lights[:rows]),
        ego_routes=tuple(
            EgoRoute(
                line=ego.route.line,
                arc=ego.route.arc,
                length=ego.route.length,
                goal=(float(ego.route.line[-1, 0]), float(ego.route.line[-1, 1])),
            )
            for ego in plan.egos
        ),
        ego_start_times=tuple(ego.ego.start_time for ego in plan.egos),
        # An unfinished episode is a run that was cut off at its last row.
        ego_ends=tuple(end.event or TerminalEvent.TIME_LIMIT for end in record.endings),
        ego_end_steps=tuple(
            end.step if end.event is not None else record.last_step for end in record.endings
        ),
        contacts=tuple(record.contacts),
        light_ids=tuple(program.id for program in plan.programs),
        light_states=light_states,
        light_state_names=tuple(names),
        # Indices are those of this network's reader; ids outlast it. Those of other lanes, of which
        # a large network has thousands, are not recorded.
        lane_ids={
            index: plan.network.lanes[index].id for index in np.unique(lanes).tolist() if index >= 0
        },
        log_names=record.log_names,
        log_values=copy_unless_over(world.logs[:rows]),
        log_events=tuple(
            LogEvent(step=step, ego=m, message=message)
            for m, log in enumerate(record.logs)
            for step, message in log.events
        ),
        # Logs are by ego; a reader goes through the plans step by step.
        plans=tuple(
            sorted(
                (
                    PlannedPath(step=step, ego=m, points=points)
                    for m, log in enumerate(record.logs)
                    for step, points in log.plans
                ),
                key=lambda path: (path.step, path.ego),
            )
        ),
        references=_references(plan.scenario.ego_vehicles),
        privileged=record.privileged,
        max_sim_time=plan.max_sim_time,
        # A key of what the run does not have is left out, as in traces that are older than the key.
        meta={
            "seed": plan.scenario.seed,
            FRICTION: plan.weather.friction,
            PERCEPTION_RANGE: plan.weather.perception_range,
            **({PATCHES_KEY: [p.to_record() for p in plan.patches]} if plan.patches else {}),
            **encode_weather_changes(record.weather_changes),
        },
    )


def _references(egos: Sequence[EgoVehicle]) -> tuple[FloatArray, ...]:
    """Returns the reference paths of the egos; nothing if none has one."""
    if not any(ego.reference_path for ego in egos):
        return ()
    return tuple(
        np.array(
            [
                (pose.time, pose.x, pose.y, pose.yaw, pose.speed, pose.z or 0.0)
                for pose in ego.reference_path
            ],
            dtype=np.float64,
        ).reshape(-1, len(PoseCol))
        for ego in egos
    )


def encode_weather_changes(changes: Sequence[tuple[int, WeatherEffects]]) -> dict[str, Any]:
    """Returns what the trace tells of changes of the weather; nothing if there are none."""
    if not changes:
        return {}
    told = [
        {"step": step, FRICTION: now.friction, PERCEPTION_RANGE: now.perception_range}
        for step, now in changes
    ]
    return {CHANGES_KEY: told}


@lru_cache(maxsize=4)
def _speed_limits(network: RoadNetwork) -> FloatArray:
    """Returns the (n,) speed limit of each lane, m/s."""
    return np.array([lane.speed_limit for lane in network.lanes])
