"""Drivora's side of the protocol: contexts and observations as messages, answers as controls."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Iterator
from functools import lru_cache

import numpy as np

from drivora_service.agents.interface import (
    AccelerationControl,
    AgentContext,
    Control,
    Observation,
    PedalControl,
    PoseControl,
    TrajectoryControl,
)
from drivora_service.agents.raster.raster_route import signal_lane
from drivora_service.agents.raster.raster_settings import Channel, RasterSettings
from drivora_service.agents.remote import agent_pb2 as pb
from drivora_service.agents.remote.protocol import MAX_RASTERS, VERSION
from drivora_service.errors import AgentError
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.networks.road_network import Lane, RoadNetwork
from drivora_service.networks.routes.lane_route import LaneRoute
from drivora_service.scenario.models.actor_models import ActorModel

SURROUNDINGS = 100.0
"""Range around the route within which lanes are sent, metres."""

_STRIDE = 20
"""Interval of the checked points of the route, which are at most 1 m apart."""


def setup_request(context: AgentContext, run: str) -> pb.SetupRequest:
    """Returns the message that begins a run."""
    return pb.SetupRequest(
        protocol=VERSION,
        run=run,
        ego_id=context.ego_id,
        vehicle=_vehicle(context.model),
        route=_route(context.network, context.route),
        lanes=lanes_around(context.network, context.route),
        step_length=context.step_length,
        friction=context.friction,
        seed=context.seed,
        parameters_json=json.dumps(dict(context.parameters), sort_keys=True),
        raster_channels=[channel.label for channel in Channel],
    )


def requested_rasters(reply: pb.SetupReply) -> tuple[RasterSettings, ...]:
    """Returns the images that an ADS requests.

    Raises:
        AgentError: It requests too many, or one that cannot be drawn.
    """
    if len(reply.rasters) > MAX_RASTERS:
        raise invalid(
            f"the ADS requests {len(reply.rasters)} rasters; allowed: at most {MAX_RASTERS}"
        )
    return tuple(map(_raster_settings, reply.rasters))


def _raster_settings(message: pb.RasterRequest) -> RasterSettings:
    known = {channel.label: channel for channel in Channel}
    for name in message.channels:
        if name not in known:
            raise invalid(
                f"the ADS requests a raster with the channel {name[:100]!r}; allowed: "
                f"{', '.join(known)}"
            )
    try:
        return RasterSettings(
            height=message.height,
            width=message.width,
            metres_per_pixel=message.metres_per_pixel,
            ego_from_top=message.ego_from_top,
            ego_from_left=message.ego_from_left,
            channels=tuple(known[name] for name in message.channels),
            history=tuple(message.history),
        )
    except AgentError as error:
        raise invalid(f"the ADS requests a raster that cannot be drawn: {error}") from error


def step_request(
    observation: Observation, run: str, rasters: Iterable[bytes] = ()
) -> pb.StepRequest:
    """Returns the message of a step, with the images that the ADS requested."""
    return pb.StepRequest(
        run=run,
        time=observation.time,
        step=observation.step,
        ego=observation.ego.tolist(),
        speed=observation.speed,
        acceleration=observation.acceleration,
        steer=observation.steer,
        route_s=observation.route_s,
        route_lateral=observation.route_lateral,
        objects=observation.objects.ravel().tolist(),
        object_sizes=observation.object_sizes.ravel().tolist(),
        object_kinds=observation.object_kinds.tolist(),
        object_ids=observation.object_ids.tolist(),
        light=int(observation.light),  # type: ignore[arg-type] # the numbers are the same
        light_protected=observation.light_protected,
        light_distance=observation.light_distance,
        speed_limit=observation.speed_limit,
        rasters=rasters,
    )


def control_of(reply: pb.StepReply) -> Control:
    """Returns the control in an ADS's answer.

    Raises:
        AgentError: There is none, or it has a number that is not finite.
    """
    match reply.WhichOneof("control"):
        case "pedals":
            pedals = reply.pedals
            _refuse_odd(reply, pedals.throttle, pedals.brake, pedals.steer)
            return PedalControl(pedals.throttle, pedals.brake, pedals.steer)
        case "acceleration":
            drive = reply.acceleration
            _refuse_odd(reply, drive.acceleration, drive.steer)
            return AccelerationControl(drive.acceleration, drive.steer)
        case "pose":
            pose = reply.pose
            speed = pose.speed if pose.HasField("speed") else None
            _refuse_odd(reply, pose.x, pose.y, pose.yaw, speed or 0.0)
            return PoseControl(pose.x, pose.y, pose.yaw, speed)
        case "trajectory":
            points = np.array(reply.trajectory.points)
            _refuse_odd(reply, *points.tolist())
            if len(points) % 4:
                raise invalid(
                    f"the ADS answered a trajectory of {len(points)} numbers; allowed: four for "
                    "each point (time, x, y, speed)"
                )
            return TrajectoryControl(points.reshape(-1, 4))
        case _:
            raise invalid(
                "the ADS answered no control; allowed: pedals, acceleration, pose, trajectory"
            )


def invalid(message: str) -> AgentError:
    """Returns the error of an answer without a control."""
    return AgentError(message, cause="agent_invalid_control")


def _refuse_odd(reply: pb.StepReply, *numbers: float) -> None:
    if not math.isfinite(sum(numbers)):
        text = " ".join(str(reply)[:200].split())
        raise invalid(f"the ADS answered a number that is not finite: {text}")


def _vehicle(model: ActorModel) -> pb.Vehicle:
    return pb.Vehicle(
        model=model.name,
        length=model.length,
        width=model.width,
        wheelbase=model.wheelbase,
        mass=model.mass,
        max_acceleration=model.max_acceleration,
        max_deceleration=model.max_deceleration,
        max_steer=model.max_steer,
        max_speed=model.max_speed,
    )


def _route(network: RoadNetwork, route: LaneRoute) -> pb.Route:
    widths = np.array([lane.width for lane in network.lanes])
    return pb.Route(
        line=route.line.ravel().tolist(),
        arc=route.arc.tolist(),
        speed_limits=route.speed_limits.tolist(),
        widths=widths[route.point_lanes].tolist(),
        lane_ids=route.point_lanes.tolist(),
        signals=[
            pb.Signal(s=signal.s, lane_id=signal_lane(network, route, signal))
            for signal in route.signals
        ],
        runs=[pb.LaneRun(lane_ids=run.lanes) for run in route.runs],
        stop_signs=route.stop_signs.tolist(),
    )


@lru_cache(maxsize=64)
def lanes_around(network: RoadNetwork, route: LaneRoute) -> tuple[pb.Lane, ...]:
    """Returns the drivable lanes whose bounding box is within reach of the route, by index."""
    near = route.line[::_STRIDE]
    return tuple(
        _lane(network, lane)
        for lane in network.lanes
        if lane.drivable and _is_near(lane.shape, near)
    )


def _is_near(shape: FloatArray, points: FloatArray) -> bool:
    reach = SURROUNDINGS + _STRIDE
    low, high = shape.min(axis=0) - reach, shape.max(axis=0) + reach
    return bool(np.any(np.all((points >= low) & (points <= high), axis=1)))


def _lane(network: RoadNetwork, lane: Lane) -> pb.Lane:
    return pb.Lane(
        id=lane.index,
        line=lane.shape.ravel().tolist(),
        width=lane.width,
        speed_limit=lane.speed_limit,
        successors=list(_successors(network, lane)),
        left=lane.left if lane.left >= 0 else None,
        right=lane.right if lane.right >= 0 else None,
        # Inside a junction, lanes of one edge lead to different places.
        may_change_left=lane.left >= 0 and not lane.is_internal,
        may_change_right=lane.right >= 0 and not lane.is_internal,
        in_junction=lane.is_internal,
    )


def _successors(network: RoadNetwork, lane: Lane) -> Iterator[int]:
    for index in dict.fromkeys(connection.to_lane for connection in lane.connections):
        if network.lanes[index].drivable:
            yield index
