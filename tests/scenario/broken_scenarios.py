"""Scenarios in which something is wrong."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import fields, is_dataclass, replace
from typing import Any

from drivora_service.scenario import model
from drivora_service.scenario.model import Scenario

Change = Callable[[Scenario], Scenario]

_PARTS = ("background_traffic", "region_segment")
"""What is no number where it is given."""


def leaves(value: object, place: tuple[str | int, ...] = ()) -> list[tuple[str | int, ...]]:
    """Places of all numbers of a scenario, also of those that are not given."""
    if is_dataclass(value):
        names = [field.name for field in fields(value)]
        return [leaf for name in names for leaf in leaves(getattr(value, name), (*place, name))]
    if isinstance(value, tuple):
        return [leaf for i, item in enumerate(value) for leaf in leaves(item, (*place, i))]
    is_number = isinstance(value, int | float) or (value is None and place[-1] not in _PARTS)
    return [place] if is_number else []


def with_value(whole: Any, place: tuple[str | int, ...], value: object) -> Any:
    """A copy with another value at a place."""
    if not place:
        return value
    key, *rest = place
    if isinstance(key, int):
        return (*whole[:key], with_value(whole[key], tuple(rest), value), *whole[key + 1 :])
    return replace(whole, **{key: with_value(getattr(whole, key), tuple(rest), value)})


def with_ego(scenario: Scenario, **changes: Any) -> Scenario:
    first, *others = scenario.ego_vehicles
    return replace(scenario, ego_vehicles=(replace(first, **changes), *others))


def with_route(scenario: Scenario, change: Callable[[Any], Any]) -> Scenario:
    return with_ego(scenario, route=tuple(change(scenario.ego_vehicles[0].route)))


def shifted(scenario: Scenario, metres: float) -> Scenario:
    def moved(place: model.Waypoint) -> model.Waypoint:
        return replace(place, x=place.x + metres, y=place.y + metres)

    return with_route(scenario, lambda route: map(moved, route))


def with_parked(scenario: Scenario, **changes: Any) -> Scenario:
    where = scenario.ego_vehicles[0].route[0]
    parked = model.NpcVehicle(id="parked", model="vehicle.audi.tt", route=(where,))
    return replace(scenario, npc_vehicles=(*scenario.npc_vehicles, replace(parked, **changes)))


def with_lights(scenario: Scenario, **junctions: model.LightTimes) -> Scenario:
    lights = replace(scenario.traffic_lights, junctions=junctions)
    return replace(scenario, traffic_lights=lights)


def with_cone(scenario: Scenario, **changes: Any) -> Scenario:
    where = scenario.ego_vehicles[0].route[-1]
    cone = model.NpcObstacle(id="cone", model="static.prop.trafficcone01", location=where)
    obstacles = (*scenario.npc_obstacles, replace(cone, **changes))
    return replace(scenario, npc_obstacles=obstacles)


def with_patch(scenario: Scenario, **changes: Any) -> Scenario:
    where = scenario.ego_vehicles[0].route[0]
    ice = model.FrictionPatch(id="ice", location=where, length=9.0, width=3.0, friction=0.1)
    return replace(scenario, friction_patches=(replace(ice, **changes),))


def with_walker(scenario: Scenario, **changes: Any) -> Scenario:
    where = scenario.ego_vehicles[0].route[0]
    walker = model.NpcWalker(id="walker", model="walker.pedestrian.0001", route=(where,))
    return replace(scenario, npc_walkers=(*scenario.npc_walkers, replace(walker, **changes)))


def with_region(scenario: Scenario, reach: float) -> Scenario:
    start = scenario.ego_vehicles[0].route[0]
    segment = model.Region(
        min_x=start.x - reach, max_x=start.x + reach, min_y=start.y - reach, max_y=start.y + reach
    )
    return replace(scenario, map_region=replace(scenario.map_region, region_segment=segment))


def with_agent(scenario: Scenario, name: str, **parameters: Any) -> Scenario:
    return with_ego(scenario, agent=model.AgentChoice(name=name, parameters=parameters))


def with_background(scenario: Scenario, count: Any) -> Scenario:
    return replace(scenario, background_traffic=model.BackgroundTraffic(count=count))


WIDE = model.Waypoint(x=-2e6, y=3.0)
CHANGES: dict[str, Change] = {
    "an ego on another": lambda s: replace(
        s, ego_vehicles=(*s.ego_vehicles, replace(s.ego_vehicles[0], id="twin"))
    ),
    "an ego twice": lambda s: replace(s, ego_vehicles=(*s.ego_vehicles, s.ego_vehicles[0])),
    "ids twice": lambda s: with_cone(with_parked(s, id="ego_0"), id="ego_0"),
    "a patch": with_patch,
    "a patch with an actor's id": lambda s: with_patch(s, id="ego_0"),
    "a patch off the network": lambda s: with_patch(s, location=WIDE),
    "a patch without friction": lambda s: with_patch(s, friction=0.0),
    "a patch outside the region": lambda s: with_region(
        with_patch(s, location=s.ego_vehicles[0].route[-1]), 1.0
    ),
    "no ego": lambda s: replace(s, ego_vehicles=()),
    "65 egos": lambda s: replace(s, ego_vehicles=s.ego_vehicles[:1] * 65),
    "2001 waypoints": lambda s: with_route(s, lambda route: route[:1] * 2001),
    "no route": lambda s: with_ego(s, route=()),
    "a route of one waypoint": lambda s: with_route(s, lambda route: route[:1]),
    "no way to go": lambda s: with_route(s, lambda route: (route[0], route[0])),
    "the wrong way": lambda s: with_route(s, reversed),
    "beside the lanes": lambda s: shifted(s, 5.0),
    "off the road": lambda s: shifted(s, 30.0),
    "off the network": lambda s: shifted(s, -5000.0),
    "too fast": lambda s: with_ego(s, model="vehicle.bh.crossbike", initial_speed=90),
    "an unknown agent": lambda s: with_agent(s, "imd"),
    "no name of an agent": lambda s: with_agent(s, "../idm"),
    "bad parameters": lambda s: with_agent(s, "idm", a=-1, b=2, c=-3),
    "drivers who do not go together": lambda s: replace(
        s,
        ego_vehicles=tuple(
            replace(ego, agent=model.AgentChoice(name="slow", parameters={"model": number}))
            for number, ego in enumerate((s.ego_vehicles[0], *s.ego_vehicles), start=1)
        ),
    ),
    "large parameters": lambda s: with_agent(s, "idm", a="x" * 300_000),
    "an unknown model": lambda s: with_ego(s, model="vehicle.mkz_2O17"),
    "a model of another kind": lambda s: with_ego(s, model="static.prop.box01"),
    "no name of a model": lambda s: with_ego(s, model="a b"),
    "no id": lambda s: with_ego(s, id=""),
    "an unknown town": lambda s: replace(s, map_region=replace(s.map_region, town="nowhere")),
    "no name of a town": lambda s: replace(s, map_region=replace(s.map_region, town="../x")),
    "an unknown light": lambda s: with_lights(s, none=model.LightTimes()),
    "a bad time of a light": lambda s: with_lights(s, none=model.LightTimes(green=-1.0)),
    "no name of a light": lambda s: with_lights(s, **{"": model.LightTimes(red=math.nan)}),
    "in an ego": lambda s: with_parked(s),
    "parked far off": lambda s: with_parked(s, route=(WIDE,)),
    "a vehicle without a route": lambda s: with_parked(s, route=()),
    "driven by SUMO nowhere": lambda s: with_parked(s, behavior=model.NpcBehavior.SUMO),
    "a walker in an ego": lambda s: with_walker(s),
    "a walker without a route": lambda s: with_walker(s, route=()),
    "a walker that is too fast": lambda s: with_walker(s, route=(replace(WIDE, speed=11.0),)),
    "a cone of no size": lambda s: with_cone(s, length=0.0),
    "a cone that moves": lambda s: with_cone(s, location=replace(WIDE, x=0.0, speed=1.0)),
    "a small region": lambda s: with_region(s, 10.0),
    "an empty region": lambda s: with_region(s, 0.0),
    "too much traffic": lambda s: with_background(s, 2001),
    "no amount of traffic": lambda s: with_background(s, None),
    "a broken amount of traffic": lambda s: with_background(s, 1.5),
    "a bad extension": lambda s: replace(s, extensions={"x": 1}),
    "many extensions": lambda s: replace(s, extensions={f"a:{i}": i for i in range(65)}),
    "an angle of many turns": lambda s: with_route(
        s, lambda route: (replace(route[0], yaw=1e4), *route[1:])
    ),
}
"""What can be wrong with a scenario, and a few oddities that may be right."""
HARMLESS = ("a patch", "an angle of many turns", "beside the lanes", "the wrong way")
