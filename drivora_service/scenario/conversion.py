"""Conversion of a document to a scenario in the network's plane: metres, radians, full model names.

Without checks, which are in ``scenario.validation``.
"""

from __future__ import annotations

from drivora_service.networks.road_network import RoadNetwork
from drivora_service.scenario import entities, model
from drivora_service.scenario.documents import Frame, ScenarioDocument
from drivora_service.scenario.frames import FrameTransform
from drivora_service.scenario.models.actor_models import ActorKind, actor_model

DEFAULT_AGENT = "idm"


def frame_of(content: ScenarioDocument | model.Scenario, network: RoadNetwork) -> FrameTransform:
    """Returns the transform from a document's frame to the network's plane.

    A scenario is in that plane already.
    """
    if isinstance(content, model.Scenario) or content.frame is Frame.SUMO:
        return FrameTransform()
    offset_x, offset_y = network.net_offset
    return FrameTransform(offset_x=offset_x, offset_y=offset_y, mirrored=True)


def drivable_kilometres(network: RoadNetwork) -> float:
    """Returns the length of all drivable lanes outside junctions, kilometres."""
    metres = sum(lane.length for lane in network.lanes if lane.drivable and not lane.is_internal)
    return metres / 1000.0


def waypoint(place: entities.PlaceDocument, frame: FrameTransform) -> model.Waypoint:
    """Converts a place of a document."""
    x, y = frame.to_network(place.x, place.y)
    return model.Waypoint(
        x=x,
        y=y,
        z=place.z,
        yaw=None if place.yaw is None else frame.yaw_to_network(place.yaw),
        speed=getattr(place, "speed", None),
        wait=getattr(place, "wait", None),
    )


def patch(one: entities.FrictionPatchDocument, frame: FrameTransform) -> model.FrictionPatch:
    """Converts a slippery patch."""
    return model.FrictionPatch(
        id=one.id,
        location=waypoint(one.location, frame),
        length=one.length,
        width=one.width,
        friction=one.friction,
    )


def background_count(background: entities.BackgroundTrafficDocument, network: RoadNetwork) -> int:
    """Returns the number of vehicles for ``count`` or ``density``."""
    if background.count is not None:
        return background.count
    return round((background.density or 0.0) * drivable_kilometres(network))


def to_scenario(document: ScenarioDocument, network: RoadNetwork) -> model.Scenario:
    """Converts a document whose models exist.

    Raises:
        UnknownName: A model does not exist.
    """
    frame = frame_of(document, network)
    background = document.background_traffic
    return model.Scenario(
        ego_vehicles=tuple(_ego(ego, frame) for ego in document.ego_vehicles),
        npc_vehicles=tuple(
            model.NpcVehicle(
                id=npc.id,
                model=actor_model(ActorKind.VEHICLE, npc.model).name,
                route=tuple(waypoint(place, frame) for place in npc.route),
                start_time=npc.start_time,
                behavior=npc.behavior,
                at_end=npc.at_end,
                deceleration=npc.deceleration,
                lateral_acceleration=npc.lateral_acceleration,
                joins=npc.joins,
            )
            for npc in document.npc_vehicles
        ),
        npc_walkers=tuple(
            model.NpcWalker(
                id=walker.id,
                model=actor_model(ActorKind.WALKER, walker.model).name,
                route=tuple(waypoint(place, frame) for place in walker.route),
                start_time=walker.start_time,
                joins=walker.joins,
            )
            for walker in document.npc_walkers
        ),
        npc_obstacles=tuple(
            model.NpcObstacle(
                id=obstacle.id,
                model=actor_model(ActorKind.OBSTACLE, obstacle.model).name,
                location=waypoint(obstacle.location, frame),
                length=obstacle.length,
                width=obstacle.width,
                start_time=obstacle.start_time,
            )
            for obstacle in document.npc_obstacles
        ),
        friction_patches=tuple(patch(one, frame) for one in document.friction_patches),
        map_region=model.MapRegion(
            town=document.map_region.town,
            region_segment=region(document.map_region.region_segment, frame),
        ),
        weather=model.Weather(**document.weather.model_dump()),
        weather_changes=tuple(
            model.WeatherChange(
                time=change.time, weather=model.Weather(**change.weather.model_dump())
            )
            for change in document.weather_changes
        ),
        traffic_lights=_traffic_lights(document.traffic_lights),
        background_traffic=None
        if background is None
        else model.BackgroundTraffic(
            count=background_count(background, network), start_time=background.start_time
        ),
        seed=document.seed,
        step_length=document.step_length,
        max_sim_time=document.max_sim_time,
        stuck_after=document.stuck_after,
        extensions=dict(document.extensions),
    )


def region(
    segment: entities.RegionDocument | model.Region | None, frame: FrameTransform
) -> model.Region | None:
    """Converts a rectangle; in a mirrored frame its southern edge becomes the northern one."""
    if segment is None:
        return None
    x1, y1 = frame.to_network(segment.min_x, segment.min_y)
    x2, y2 = frame.to_network(segment.max_x, segment.max_y)
    return model.Region(min_x=x1, max_x=x2, min_y=min(y1, y2), max_y=max(y1, y2))


def _ego(ego: entities.EgoDocument, frame: FrameTransform) -> model.EgoVehicle:
    return model.EgoVehicle(
        id=ego.id,
        model=actor_model(ActorKind.VEHICLE, ego.model).name,
        route=tuple(waypoint(place, frame) for place in ego.route),
        agent=model.AgentChoice(
            name=ego.agent_name or DEFAULT_AGENT,
            parameters={} if ego.agent is None else dict(ego.agent.parameters),
        ),
        start_time=ego.start_time,
        initial_speed=ego.initial_speed,
        dynamics=ego.dynamics,
        reference_path=tuple(_pose(pose, frame) for pose in ego.reference_path),
    )


def _pose(pose: entities.ReferencePoseDocument, frame: FrameTransform) -> model.ReferencePose:
    x, y = frame.to_network(pose.x, pose.y)
    return model.ReferencePose(
        time=pose.time,
        x=x,
        y=y,
        yaw=frame.yaw_to_network(pose.yaw),
        speed=pose.speed,
        z=pose.z,
    )


def _traffic_lights(lights: entities.TrafficLightsDocument) -> model.TrafficLights:
    return model.TrafficLights(
        times=_light_times(lights, lights),
        junctions={
            junction: _light_times(times, lights) for junction, times in lights.junctions.items()
        },
    )


def _light_times(
    times: entities.LightTimesDocument, general: entities.LightTimesDocument
) -> model.LightTimes:
    """Converts times; missing ones come from the general times."""
    return model.LightTimes(
        green=general.green_time if times.green_time is None else times.green_time,
        yellow=general.yellow_time if times.yellow_time is None else times.yellow_time,
        red=general.red_time if times.red_time is None else times.red_time,
        offset=general.offset if times.offset is None else times.offset,
    )
