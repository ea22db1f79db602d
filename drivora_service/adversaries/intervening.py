"""Interventions: what an action of an adversary adds to a running episode."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from typing import Any

from drivora_service.adversaries.adversary_situation import Situation
from drivora_service.adversaries.adversary_vehicles import (
    MANOEUVRES,
    vehicle_across,
    vehicle_on_route,
)
from drivora_service.adversaries.adversary_walkers import CROSSINGS, walker_across
from drivora_service.geometry.boxes import box_gap
from drivora_service.runs.adversary import Action
from drivora_service.scenario.checks.place_checks import check_places
from drivora_service.scenario.checks.placed_actors import place_actors
from drivora_service.scenario.checks.route_checks import check_route
from drivora_service.scenario.checks.start_overlaps import StartPose
from drivora_service.scenario.frames import FrameTransform
from drivora_service.scenario.model import NpcVehicle, NpcWalker, Scenario, Weather
from drivora_service.scenario.models.actor_models import ActorKind, actor_model
from drivora_service.simulation.episode import Episode

_ROOM = 1.0
"""Metres that must be free around an actor that appears."""


SKIES: Mapping[Action, Mapping[str, float]] = {
    Action.CLEAR_SKY: {
        "cloudiness": 0.0,
        "precipitation": 0.0,
        "precipitation_deposits": 0.0,
        "wetness": 0.0,
        "fog_density": 0.0,
    },
    Action.LIGHT_RAIN: {"cloudiness": 60.0, "precipitation": 30.0, "wetness": 40.0},
    Action.HEAVY_RAIN: {"cloudiness": 100.0, "precipitation": 100.0, "wetness": 100.0},
    Action.FOG: {"fog_density": 80.0},
    Action.NOON: {"sun_altitude_angle": 70.0},
    Action.DUSK: {"sun_altitude_angle": 3.0},
    Action.NIGHT: {"sun_altitude_angle": -10.0},
}
"""The conditions that an action sets, as fields of ``Weather``; the others stay."""


def sky(action: Action, weather: Weather) -> Weather:
    """Returns the weather after an action."""
    return replace(weather, **SKIES[action])


@dataclass(frozen=True, slots=True, kw_only=True)
class Intervention:
    """What came of a decision.

    Attributes:
        time: Seconds.
        action: The action.
        actors: Ids of the actors that it added.
        weather: Conditions that it changed, with their new values.
    """

    time: float
    action: Action
    actors: tuple[str, ...] = ()
    weather: dict[str, float] = field(default_factory=dict)

    @property
    def has_effect(self) -> bool:
        """Whether it added or changed anything."""
        return bool(self.actors or self.weather)

    def to_json(self) -> dict[str, Any]:
        """Returns it as plain data for a document."""
        content: dict[str, Any] = {"time": round(self.time, 6), "action": self.action.value}
        if self.actors:
            content["actors"] = list(self.actors)
        if self.weather:
            content["weather"] = self.weather
        return content


def intervene(episode: Episode, situation: Situation, action: Action) -> Intervention:
    """Does an action in the present situation.

    It has no effect where the road does not allow it, where actors are in the way of one that
    would appear, and where the weather is already the wanted one.
    """
    done = Intervention(time=situation.time, action=action)
    if action in SKIES:
        return _change_sky(episode, situation, done)
    actor = _actor(situation, action)
    if actor is None or not _can_appear(episode.scenario, situation, actor):
        return done
    if isinstance(actor, NpcWalker):
        episode.add_walker(actor)
    else:
        episode.add_vehicle(actor)
    return Intervention(time=situation.time, action=action, actors=(actor.id,))


def _change_sky(episode: Episode, situation: Situation, done: Intervention) -> Intervention:
    weather = sky(done.action, situation.weather)
    if weather == situation.weather:
        return done
    episode.change_weather(weather)
    before = asdict(situation.weather)
    changed = {name: value for name, value in asdict(weather).items() if before[name] != value}
    return Intervention(time=done.time, action=done.action, weather=changed)


def _actor(situation: Situation, action: Action) -> NpcVehicle | NpcWalker | None:
    """Returns the actor that an action adds; ``None``: none, or there is no place for it."""
    name = f"adversary:{situation.number}"
    if action in MANOEUVRES:
        return vehicle_on_route(situation, MANOEUVRES[action], name)
    if action in CROSSINGS:
        return walker_across(situation, CROSSINGS[action], name)
    if action is Action.VEHICLE_CROSSES:
        return vehicle_across(situation, name)
    return None


def _can_appear(scenario: Scenario, situation: Situation, actor: NpcVehicle | NpcWalker) -> bool:
    """Returns whether a document may have the actor, and its place is free."""
    known: tuple[NpcVehicle | NpcWalker, ...] = (*scenario.npc_vehicles, *scenario.npc_walkers)
    if any(one.id == actor.id for one in known):
        return False
    alone = Scenario(
        ego_vehicles=(),
        npc_vehicles=(actor,) if isinstance(actor, NpcVehicle) else (),
        npc_walkers=(actor,) if isinstance(actor, NpcWalker) else (),
        map_region=scenario.map_region,
        weather=Weather(),
    )
    (placed,), _ = place_actors(alone, FrameTransform())
    if check_places((placed,), situation.network, situation.region)[0]:
        return False
    problems, pose = check_route(placed, situation.network)
    return not problems and pose is not None and _is_free(situation, actor, pose)


def _is_free(situation: Situation, actor: NpcVehicle | NpcWalker, pose: StartPose) -> bool:
    """Returns whether the start of an actor that appears at once is free of others."""
    if actor.start_time > situation.time:
        # Whoever is there then is not known now.
        return True
    kind = ActorKind.VEHICLE if isinstance(actor, NpcVehicle) else ActorKind.WALKER
    model = actor_model(kind, actor.model)
    return all(
        box_gap(
            one.x - pose.x, one.y - pose.y, pose.yaw, model.length, model.width, one.yaw,
            one.length, one.width,
        ) >= _ROOM
        for one in (situation.ego, *situation.others)
    )  # fmt: skip
