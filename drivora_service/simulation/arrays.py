"""Plans laid out as the arrays that the step kernels run over."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drivora_service.networks.lane_route import LaneRoute
from drivora_service.scenario.actor_models import ActorModel
from drivora_service.simulation.dynamics import Limit
from drivora_service.simulation.followers import Followers, Phase, Reaction
from drivora_service.simulation.lights import RunningProgram, light_of
from drivora_service.simulation.plan import EgoPlan, FollowerPlan
from drivora_service.simulation.step_kernels import PERMISSIVE

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


def _offsets(counts: Sequence[int]) -> IntArray:
    return np.concatenate(([0], np.cumsum(counts, dtype=np.int64))).astype(np.int64)


def vehicle_limits(models: Sequence[ActorModel], dynamic: Sequence[bool]) -> FloatArray:
    """Gives the (M, 8) limits of vehicles under control, columns ``Limit``."""
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
    """Lays follower plans end to end, all waiting for their start."""
    count = len(plans)
    models = [plan.model for plan in plans]

    def joined(parts: list[FloatArray], shape: tuple[int, ...]) -> FloatArray:
        return np.concatenate(parts) if parts else np.empty(shape)

    return Followers(
        rows=np.array(rows, dtype=np.int64),
        first=_offsets([len(plan.path.arc) for plan in plans]),
        line=joined([plan.path.line for plan in plans], (0, 2)),
        yaw=joined([plan.path.yaw for plan in plans], (0,)),
        arc=joined([plan.path.arc for plan in plans], (0,)),
        wanted=joined([plan.path.wanted for plan in plans], (0,)),
        height=joined([plan.path.height for plan in plans], (0,)),
        s=np.zeros(count),
        speed=np.array([plan.first_speed for plan in plans], dtype=np.float64),
        cursor=np.zeros(count, dtype=np.int64),
        phase=np.full(count, int(Phase.WAITING), dtype=np.int64),
        start_time=np.array([plan.start_time for plan in plans], dtype=np.float64),
        reaction=np.array(
            [int(Reaction.BRAKES if plan.reacts else Reaction.NONE) for plan in plans],
            dtype=np.int64,
        ),
        stays=np.array([plan.stays for plan in plans], dtype=np.bool_),
        max_acceleration=np.array([m.max_acceleration for m in models], dtype=np.float64),
        max_deceleration=np.array([m.max_deceleration for m in models], dtype=np.float64),
        length=np.array([m.length for m in models], dtype=np.float64),
        width=np.array([m.width for m in models], dtype=np.float64),
    )


def append_follower(followers: Followers, plan: FollowerPlan, row: int) -> None:
    """Adds a follower during the run."""
    more = lay_followers([plan], [row])
    followers.first = np.append(followers.first, followers.first[-1] + more.first[-1])
    for name in Followers.__slots__:
        if name != "first":
            joined = np.concatenate((getattr(followers, name), getattr(more, name)))
            setattr(followers, name, joined)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RouteArrays:
    """The egos' routes and signals end to end, as ``follow_egos`` takes them."""

    first_point: IntArray
    lines: FloatArray
    arcs: FloatArray
    heights: FloatArray
    first_signal: IntArray
    signal_s: FloatArray
    signal_ends: FloatArray
    signal_codes: NDArray[np.uint8]
    signal_offsets: FloatArray


def lay_routes(egos: Sequence[EgoPlan], programs: Sequence[RunningProgram]) -> RouteArrays:
    """Lays the egos' routes end to end."""
    by_id = {program.id: program for program in programs}
    routes: list[LaneRoute] = [ego.route for ego in egos]
    signals = [
        (signal, by_id[signal.traffic_light])
        for route in routes
        for signal in route.signals
        if signal.traffic_light in by_id
    ]
    most = max((len(program.phases) for _, program in signals), default=1)
    ends = np.ones((len(signals), most))
    codes = np.zeros((len(signals), most), dtype=np.uint8)
    for i, (signal, program) in enumerate(signals):
        ends[i] = program.ends[-1]
        ends[i, : len(program.ends)] = program.ends
        for p, phase in enumerate(program.phases):
            letter = phase.state[signal.link_index]
            codes[i, p:] = PERMISSIVE if letter == "g" else int(light_of(letter))
    return RouteArrays(
        first_point=_offsets([len(route.line) for route in routes]),
        lines=np.concatenate([route.line for route in routes]),
        arcs=np.concatenate([route.arc for route in routes]),
        heights=np.concatenate([ego.heights for ego in egos]),
        first_signal=_offsets(
            [sum(s.traffic_light in by_id for s in route.signals) for route in routes]
        ),
        signal_s=np.array([signal.s for signal, _ in signals]),
        signal_ends=ends,
        signal_codes=codes,
        signal_offsets=np.array([program.offset for _, program in signals]),
    )
