"""One text for one scenario: its identity, and the form in which workers receive it.

Keys are sorted, there is no white space, floats are written with the fewest digits that read back
to the same value. The text of equal scenarios is equal, and ``from_canonical`` gives back the
identical scenario.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from functools import lru_cache
from typing import Any

from drivora_service.scenario import model

_LATER_FIELDS = ("stuck_after",)


def canonical_json(scenario: model.Scenario) -> str:
    """Writes a scenario as canonical JSON, in the network's plane, metres and radians.

    Values of ``_LATER_FIELDS`` are left out where they are ``None``, so that scenarios keep the
    identity which they had before there were these fields.
    """
    content = _plain(scenario)
    for name in _LATER_FIELDS:
        if content[name] is None:
            del content[name]
    return json.dumps(
        content,
        sort_keys=True,
        separators=(",", ":"),
        ensure_ascii=False,
        allow_nan=False,
    )


def scenario_sha256(scenario: model.Scenario) -> str:
    """Gives the SHA-256 of the canonical JSON, hexadecimal: the scenario's identity."""
    return hashlib.sha256(canonical_json(scenario).encode()).hexdigest()


def from_canonical(text: str) -> model.Scenario:
    """Reads canonical JSON; trusts it, as it was made from a validated scenario."""
    data = json.loads(text)
    map_region, background = data["map_region"], data["background_traffic"]
    lights = data["traffic_lights"]
    segment = map_region["region_segment"]
    return model.Scenario(
        ego_vehicles=tuple(
            model.EgoVehicle(
                **{
                    **ego,
                    "route": _route(ego["route"]),
                    "agent": model.AgentChoice(**ego["agent"]),
                    "dynamics": model.VehicleDynamics(ego["dynamics"]),
                }
            )
            for ego in data["ego_vehicles"]
        ),
        npc_vehicles=tuple(
            model.NpcVehicle(
                **{
                    **npc,
                    "route": _route(npc["route"]),
                    "behavior": model.NpcBehavior(npc["behavior"]),
                }
            )
            for npc in data["npc_vehicles"]
        ),
        npc_walkers=tuple(
            model.NpcWalker(**{**walker, "route": _route(walker["route"])})
            for walker in data["npc_walkers"]
        ),
        npc_obstacles=tuple(
            model.NpcObstacle(**{**obstacle, "location": model.Waypoint(**obstacle["location"])})
            for obstacle in data["npc_obstacles"]
        ),
        map_region=model.MapRegion(
            town=map_region["town"],
            region_segment=None if segment is None else model.Region(**segment),
        ),
        weather=model.Weather(**data["weather"]),
        traffic_lights=model.TrafficLights(
            times=model.LightTimes(**lights["times"]),
            junctions={
                junction: model.LightTimes(**times)
                for junction, times in lights["junctions"].items()
            },
        ),
        background_traffic=None if background is None else model.BackgroundTraffic(**background),
        seed=data["seed"],
        step_length=data["step_length"],
        max_sim_time=data["max_sim_time"],
        stuck_after=data.get("stuck_after"),
        extensions=data["extensions"],
    )


def _route(places: list[dict[str, float | None]]) -> tuple[model.Waypoint, ...]:
    return tuple(model.Waypoint(**place) for place in places)  # type: ignore[arg-type]  # x and y are never null


@lru_cache(maxsize=64)
def _field_names(kind: type) -> tuple[str, ...]:
    """Gives the names of the fields of a dataclass; none for any other class."""
    return tuple(f.name for f in fields(kind)) if is_dataclass(kind) else ()


def _plain(value: Any) -> Any:
    kind: Any = type(value)
    # Nearly all values are numbers of waypoints: they need no further look.
    if kind is float or value is None:
        return value
    if names := _field_names(kind):
        return {name: _plain(getattr(value, name)) for name in names}
    if isinstance(value, tuple | list):
        return [_plain(item) for item in value]
    if isinstance(value, Mapping):
        return {key: _plain(item) for key, item in value.items()}
    return value.value if isinstance(value, Enum) else value
