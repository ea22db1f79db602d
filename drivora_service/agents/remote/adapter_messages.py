"""The ADS's side of the protocol: messages into views, controls into answers.

Needs NumPy and protobuf only, as it runs in the environment of the ADS.
"""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np

from drivora_service.agents.interface import (
    AccelerationControl,
    Observation,
    PedalControl,
    PoseControl,
    TrajectoryControl,
)
from drivora_service.agents.log import AgentLog
from drivora_service.agents.raster.raster_settings import RasterSettings
from drivora_service.agents.remote import agent_pb2 as pb
from drivora_service.agents.remote.requested_rasters import RequestedRasters
from drivora_service.agents.remote.views import (
    ContextView,
    LaneView,
    RouteView,
    SignalView,
    VehicleView,
)
from drivora_service.observations.trace import Light

_COLUMNS = 9
_LIGHTS = tuple(Light)


def context_view(
    request: pb.SetupRequest, log: AgentLog, rasters: RequestedRasters | None = None
) -> ContextView:
    """Returns the context of a run for an adapter.

    Args:
        request: Drivora's message.
        log: Log of the ADS.
        rasters: Collects the images that the ADS requests.
    """
    return ContextView(
        ego_id=request.ego_id,
        vehicle=_vehicle(request.vehicle),
        route=_route(request.route),
        lanes={lane.id: _lane(lane) for lane in request.lanes},
        step_length=request.step_length,
        friction=request.friction,
        seed=request.seed,
        parameters=json.loads(request.parameters_json or "{}"),
        log=log,
        rasters=rasters or RequestedRasters(request.raster_channels),
    )


def raster_request(settings: RasterSettings) -> pb.RasterRequest:
    """Returns the message that requests images."""
    return pb.RasterRequest(
        height=settings.height,
        width=settings.width,
        metres_per_pixel=settings.metres_per_pixel,
        ego_from_top=settings.ego_from_top,
        ego_from_left=settings.ego_from_left,
        channels=[channel.label for channel in settings.channels],
        history=settings.history,
    )


def observation_view(request: pb.StepRequest) -> Observation:
    """Returns the ADS's observation of a step; the arrays belong to the ADS."""
    return Observation(
        time=request.time,
        step=request.step,
        ego=np.array(request.ego[:]),
        speed=request.speed,
        acceleration=request.acceleration,
        steer=request.steer,
        route_s=request.route_s,
        route_lateral=request.route_lateral,
        objects=np.array(request.objects[:], dtype=np.float64).reshape(-1, _COLUMNS),
        object_sizes=np.array(request.object_sizes[:], dtype=np.float64).reshape(-1, 2),
        object_kinds=np.array(request.object_kinds[:], dtype=np.int64),
        object_ids=np.array(request.object_ids[:], dtype=np.int64),
        light=_LIGHTS[request.light],
        light_protected=request.light_protected,
        light_distance=request.light_distance,
        speed_limit=request.speed_limit,
    )


def step_reply(control: Any, log: AgentLog) -> pb.StepReply:
    """Returns the answer: the control, and the log of this step.

    Raises:
        TypeError: It is not a control.
    """
    reply = pb.StepReply(
        values={
            name: value
            for name, value in zip(log.names, log.row.tolist(), strict=True)
            if not math.isnan(value)
        },
        text="\n".join(message for _, message in log.events),
        plan=log.plans[-1][1].ravel().tolist() if log.plans else (),
    )
    match control:
        case PedalControl():
            reply.pedals.throttle = control.throttle
            reply.pedals.brake = control.brake
            reply.pedals.steer = control.steer
        case AccelerationControl():
            reply.acceleration.acceleration = control.acceleration
            reply.acceleration.steer = control.steer
        case PoseControl():
            reply.pose.x, reply.pose.y, reply.pose.yaw = control.x, control.y, control.yaw
            if control.speed is not None:
                reply.pose.speed = control.speed
        case TrajectoryControl():
            points = np.asarray(control.points, dtype=np.float64)
            if points.ndim != 2 or points.shape[1] != 4:
                raise TypeError(
                    f"the trajectory has the shape {points.shape}; allowed: (n, 4) with the "
                    "columns time, x, y, speed"
                )
            reply.trajectory.points.extend(points.ravel().tolist())
        case _:
            raise TypeError(
                f"run_step answered {type(control).__name__}; allowed: PedalControl, "
                "AccelerationControl, PoseControl, TrajectoryControl"
            )
    return reply


def _vehicle(message: pb.Vehicle) -> VehicleView:
    return VehicleView(
        model=message.model,
        length=message.length,
        width=message.width,
        wheelbase=message.wheelbase,
        mass=message.mass,
        max_acceleration=message.max_acceleration,
        max_deceleration=message.max_deceleration,
        max_steer=message.max_steer,
        max_speed=message.max_speed,
    )


def _route(message: pb.Route) -> RouteView:
    return RouteView(
        line=np.array(message.line).reshape(-1, 2),
        arc=np.array(message.arc),
        speed_limits=np.array(message.speed_limits),
        widths=np.array(message.widths),
        lanes=np.array(message.lane_ids, dtype=np.int64),
        signals=tuple(SignalView(s=signal.s, lane=signal.lane_id) for signal in message.signals),
        runs=tuple(tuple(run.lane_ids) for run in message.runs),
        stop_signs=np.array(message.stop_signs),
    )


def _lane(message: pb.Lane) -> LaneView:
    return LaneView(
        id=message.id,
        line=np.array(message.line).reshape(-1, 2),
        width=message.width,
        speed_limit=message.speed_limit,
        successors=tuple(message.successors),
        left=message.left if message.HasField("left") else None,
        right=message.right if message.HasField("right") else None,
        may_change_left=message.may_change_left,
        may_change_right=message.may_change_right,
        in_junction=message.in_junction,
    )
