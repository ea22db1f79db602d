"""The size of a scenario, and what a smaller one lacks."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from drivora_service.networks.road_network import RoadNetwork
from drivora_service.scenario.conversion import background_count
from drivora_service.scenario.documents import ScenarioDocument
from drivora_service.store.minimizations.minimization_records import ScenarioSize
from drivora_service.suites.minimization import removals
from drivora_service.suites.minimization.edits import content_of
from drivora_service.suites.minimization.removals import ACTORS, PATCHES
from drivora_service.suites.minimization.rounding import numbers
from drivora_service.suites.minimization.shortening import route_lengths

_PLURALS = {"slippery patch": "slippery patches"}


def size_of(document: ScenarioDocument, network: RoadNetwork, *, sim_time_s: float) -> ScenarioSize:
    """Returns the size of a scenario.

    Args:
        document: The scenario.
        network: Its road network.
        sim_time_s: Simulated seconds of its run.
    """
    traffic = document.background_traffic
    background = 0 if traffic is None else background_count(traffic, network)
    named = [len(getattr(document, key)) for key in ACTORS]
    return ScenarioSize(
        actors=sum(named) + background,
        egos=named[0],
        vehicles=named[1],
        walkers=named[2],
        obstacles=named[3],
        background=background,
        patches=len(document.friction_patches),
        waypoints=sum(
            len(actor.route)
            for actors in (document.ego_vehicles, document.npc_vehicles, document.npc_walkers)
            for actor in actors
        ),
        settings=len(removals.settings(document)) + (document.max_sim_time is not None),
        route_m=round(sum(route_lengths(document, network).values()), 1),
        sim_time_s=sim_time_s,
        digits=_digits(document),
    )


def differences(
    before: ScenarioDocument, after: ScenarioDocument, network: RoadNetwork
) -> tuple[str, ...]:
    """Returns what a scenario lacks that was reduced from another one, one sentence each."""
    return (
        *_describe_removed_actors(before, after),
        *_describe_removed_settings(before, after),
        *_shorter_routes(before, after, network),
        *_describe_removed_waypoints(before, after),
        *_other_numbers(before, after),
    )


def _describe_removed_actors(before: ScenarioDocument, after: ScenarioDocument) -> Iterator[str]:
    for key, name in (*ACTORS.items(), (PATCHES, "slippery patch")):
        kept = {actor.id for actor in getattr(after, key)}
        gone = [actor.id for actor in getattr(before, key) if actor.id not in kept]
        if gone:
            title = name if len(gone) == 1 else _PLURALS.get(name, f"{name}s")
            yield f"{len(gone)} {title} removed: {', '.join(gone)}."
    was, now = before.background_traffic, after.background_traffic
    if was is not None and now is None:
        yield "Background traffic removed."
    elif was is not None and now is not None and was.count != now.count:
        yield f"{now.count} vehicles of background traffic instead of {was.count}."


def _describe_removed_settings(before: ScenarioDocument, after: ScenarioDocument) -> Iterator[str]:
    kept = _settings(after)
    names = [name for name in _settings(before) if name not in kept]
    if names:
        yield f"Settings back at their defaults: {', '.join(names)}."
    if before.max_sim_time != after.max_sim_time:
        yield (
            "The episode ends by itself."
            if after.max_sim_time is None
            else f"The episode ends at {after.max_sim_time:g} s."
        )


def _settings(document: ScenarioDocument) -> tuple[str, ...]:
    places = [edit.changes[0][0] for edit in removals.settings(document)]
    # What is part of another one goes with it.
    whole = [
        place for place in places if not any(place[:end] in places for end in range(len(place)))
    ]
    return tuple(".".join(map(str, place)) for place in whole)


def _shorter_routes(
    before: ScenarioDocument, after: ScenarioDocument, network: RoadNetwork
) -> Iterator[str]:
    were = route_lengths(before, network)
    for ego, now in route_lengths(after, network).items():
        if round(now) < round(were.get(ego, now)):
            yield f"The route of {ego} is {now:.0f} m long instead of {were[ego]:.0f} m."


def _describe_removed_waypoints(before: ScenarioDocument, after: ScenarioDocument) -> Iterator[str]:
    were = _waypoints(before)
    for actor, now in _waypoints(after).items():
        if now < were.get(actor, now):
            yield f"{actor} has {now} of {were[actor]} waypoints."


def _waypoints(document: ScenarioDocument) -> Mapping[str, int]:
    lists: Sequence[Sequence[Any]] = (
        document.ego_vehicles,
        document.npc_vehicles,
        document.npc_walkers,
    )
    return {actor.id: len(actor.route) for actors in lists for actor in actors}


def _other_numbers(before: ScenarioDocument, after: ScenarioDocument) -> Iterator[str]:
    was, now = _digits(before), _digits(after)
    if now < was:
        yield f"The numbers have {now} digits instead of {was}."


def _digits(document: ScenarioDocument) -> int:
    texts = (repr(value).removesuffix(".0") for _, value in numbers(content_of(document)))
    return sum(character.isdigit() for text in texts for character in text)
