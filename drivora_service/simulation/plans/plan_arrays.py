"""Conversion of plans to the arrays of the step kernels."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray, IntArray
from drivora_service.networks.routes.lane_route import LaneRoute
from drivora_service.observations.ground import PatchCol
from drivora_service.observations.trace import Col
from drivora_service.scenario.models.actor_models import ActorModel
from drivora_service.scenario.weather import WeatherEffects
from drivora_service.simulation.followers.follower_path import PathCol, write_directions
from drivora_service.simulation.followers.follower_state import FollowerCol, FollowerPhase, Reaction
from drivora_service.simulation.followers.followers import Followers, PlaceCol
from drivora_service.simulation.motion.route_tracking import (
    PERMISSIVE,
    Progress,
    RouteArrays,
    SignalCol,
)
from drivora_service.simulation.motion.step_kernels import GroundCol, ObstacleCol
from drivora_service.simulation.motion.vehicle_dynamics import Limit
from drivora_service.simulation.perception.ego_perception import Sense
from drivora_service.simulation.plans.episode_plan import EgoPlan, FollowerPlan, ObstaclePlan
from drivora_service.simulation.plans.light_programs import RunningProgram, light_of


def _offsets(counts: Sequence[int]) -> IntArray:
    return np.concatenate(([0], np.cumsum(counts, dtype=np.int64))).astype(np.int64)


def vehicle_limits(models: Sequence[ActorModel], dynamic: Sequence[bool]) -> FloatArray:
    """Returns the (M, 8) limits of vehicles under control, columns ``Limit``."""
    limits = np.zeros((len(models), len(Limit)))
    for row, model, is_dynamic in zip(limits, models, dynamic, strict=True):
        row[Limit.WHEELBASE] = model.wheelbase
        row[Limit.MAX_ACCELERATION] = model.max_acceleration
        row[Limit.MAX_DECELERATION] = model.max_deceleration
        row[Limit.MAX_STEER] = model.max_steer
        row[Limit.MAX_SPEED] = model.max_speed
        row[Limit.MASS] = model.mass
        # A homogeneous box about its vertical axis.
        row[Limit.YAW_INERTIA] = model.mass * (model.length**2 + model.width**2) / 12.0
        row[Limit.DYNAMIC] = float(is_dynamic)
    return limits


def lay_followers(plans: Sequence[FollowerPlan], rows: Sequence[int]) -> Followers:
    """Returns follower plans as concatenated arrays, all waiting for their start."""
    counts = [len(plan.path.arc) for plan in plans]
    begins = _offsets(counts)
    path: FloatArray = np.empty((begins[-1], len(PathCol)))
    for plan, begin, end in zip(plans, begins[:-1], begins[1:], strict=True):
        points, line = path[begin:end], plan.path
        points[:, : PathCol.YAW] = line.line
        points[:, PathCol.YAW], points[:, PathCol.ARC] = line.yaw, line.arc
        points[:, PathCol.WANTED], points[:, PathCol.HEIGHT] = line.wanted, line.height
        points[:, PathCol.WAIT] = line.wait
    write_directions(path)
    state = np.zeros((len(plans), len(FollowerCol)))
    for row, plan in zip(state, plans, strict=True):
        row[FollowerCol.SPEED] = plan.first_speed
        row[FollowerCol.PHASE] = FollowerPhase.WAITING
        row[FollowerCol.START_TIME] = plan.start_time
        row[FollowerCol.REACTION] = Reaction.BRAKES if plan.reacts else Reaction.NONE
        row[FollowerCol.STAYS] = plan.stays
        row[FollowerCol.MAX_ACCELERATION] = plan.model.max_acceleration
        row[FollowerCol.MAX_DECELERATION] = plan.model.max_deceleration
        row[FollowerCol.LENGTH] = plan.model.length
        row[FollowerCol.WIDTH] = plan.model.width
        row[FollowerCol.WAITS_FOR] = row[FollowerCol.LAST_STOP] = -1.0
        row[FollowerCol.STOOD] = -1.0
        row[FollowerCol.DECELERATION] = plan.deceleration
        stops = np.flatnonzero(plan.path.wait)
        row[FollowerCol.NEXT_STOP] = stops[0] if len(stops) else len(plan.path.wait)
    return Followers(
        places=np.array((rows, begins[:-1], counts), dtype=np.int64).T.copy(),
        path=path,
        state=state,
    )


def append_follower(followers: Followers, plan: FollowerPlan, row: int) -> Followers:
    """Returns the followers of a run and one more."""
    more = lay_followers([plan], [row])
    more.places[:, PlaceCol.PATH] += len(followers.path)
    return Followers(
        places=np.concatenate((followers.places, more.places)),
        path=np.concatenate((followers.path, more.path)),
        state=np.concatenate((followers.state, more.state)),
    )


def lay_obstacles(plans: Sequence[ObstaclePlan], rows: Sequence[int], count: int) -> FloatArray:
    """Returns static actors as (count, 10), columns ``ObstacleCol``; inf in all other rows."""
    static = np.full((count, ObstacleCol.STATE + len(Col)), np.inf)
    for plan, row in zip(plans, rows, strict=True):
        static[row, ObstacleCol.START_TIME] = plan.obstacle.start_time
        state = static[row, ObstacleCol.STATE :]
        state[:] = 0.0
        state[: Col.YAW + 1], state[Col.Z] = plan.pose, plan.height
    return static


def senses_of(weather: WeatherEffects, step_length: float) -> FloatArray:
    """Returns the (6,) senses, columns ``Sense``, of an ego that the weather limits."""
    senses = np.zeros(len(Sense))
    senses[Sense.RANGE] = weather.perception_range
    senses[Sense.POSITION_NOISE] = weather.position_noise
    senses[Sense.SPEED_NOISE] = weather.speed_noise
    senses[Sense.DROPOUT] = weather.dropout
    senses[Sense.LAG] = round(weather.latency / step_length)
    senses[Sense.HIDES] = 1.0
    return senses


def privileged_senses() -> FloatArray:
    """Returns the senses of an ego with unlimited perception."""
    senses = np.zeros(len(Sense))
    senses[Sense.RANGE] = np.inf
    return senses


def wind_of(weather: WeatherEffects) -> FloatArray:
    """Returns the (2,) acceleration by the wind, m/s²."""
    return weather.wind_acceleration * np.array(
        [math.cos(weather.wind_direction), math.sin(weather.wind_direction)]
    )


def lay_ground(weather: WeatherEffects, patches: FloatArray) -> FloatArray:
    """Returns the road as (1 + P, 8).

    The first row has the columns ``GroundCol``; the others are the patches, columns
    ``ground.PatchCol``.
    """
    ground = np.zeros((1 + len(patches), len(PatchCol)))
    ground[0, GroundCol.FRICTION] = weather.friction
    ground[0, GroundCol.WIND_X : GroundCol.WIND_Y + 1] = wind_of(weather)
    ground[1:] = patches
    return ground


def first_progress(egos: Sequence[EgoPlan], stuck_after: float) -> FloatArray:
    """Returns the (M, 11) progress of egos that have not started, columns ``Progress``."""
    progress = np.zeros((len(egos), len(Progress)))
    progress[:, Progress.STUCK_AFTER] = stuck_after
    progress[:, Progress.TIME_LIMIT] = [ego.time_limit for ego in egos]
    progress[:, Progress.ROUTE_S] = progress[:, Progress.ROUTE_LATERAL] = np.nan
    progress[:, Progress.LIGHT_DISTANCE] = np.inf
    progress[:, Progress.SPEED_LIMIT] = [ego.route.speed_limits[0] for ego in egos]
    return progress


def lay_routes(egos: Sequence[EgoPlan], programs: Sequence[RunningProgram]) -> RouteArrays:
    """Concatenates the egos' routes."""
    by_id = {program.id: program for program in programs}
    routes: list[LaneRoute] = [ego.route for ego in egos]
    signals = [
        (signal, by_id[signal.traffic_light])
        for route in routes
        for signal in route.signals
        if signal.traffic_light in by_id
    ]
    most = max((len(program.phases) for _, program in signals), default=1)
    codes_from = SignalCol.STAGES + most
    laid = np.zeros((len(signals), codes_from + most))
    for row, (signal, program) in zip(laid, signals, strict=True):
        ends, codes = row[SignalCol.STAGES : codes_from], row[codes_from:]
        row[SignalCol.STOP_LINE], row[SignalCol.OFFSET] = signal.s, program.offset
        ends[:] = program.ends[-1]
        ends[: len(program.ends)] = program.ends
        for p, phase in enumerate(program.phases):
            letter = phase.state[signal.link_index]
            codes[p:] = PERMISSIVE if letter == "g" else int(light_of(letter))
    points = _offsets([len(route.line) for route in routes])
    counts = _offsets([sum(s.traffic_light in by_id for s in route.signals) for route in routes])
    return RouteArrays(
        points=np.concatenate(
            [
                np.column_stack(
                    (ego.route.line, ego.route.arc, ego.heights, ego.route.speed_limits)
                )
                for ego in egos
            ]
        ),
        signals=laid,
        parts=np.column_stack((points[:-1], points[1:], counts[:-1], counts[1:])),
    )
