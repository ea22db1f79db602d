"""Notes on figures of a campaign that are far from what its seed scenarios allow."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from drivora_service.campaigns.document.campaign_documents import SpaceDocument
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.scenario.checks.noted_figures import (
    FAST_FACTOR,
    duration_words,
    limit_near,
    other_unit,
    placed,
    speed_words,
)
from drivora_service.scenario.checks.speed_notes import wanted_speed_notes
from drivora_service.scenario.checks.time_notes import latest_end
from drivora_service.scenario.model import AgentChoice, Scenario
from drivora_service.scenario.waypoint_speeds import GRAVITY


def range_notes(
    space: SpaceDocument, seeds: Sequence[tuple[Scenario, RoadNetwork]]
) -> Iterator[str]:
    """Yields a note for each such range, with its place in the campaign.

    Args:
        space: The space.
        seeds: The seed scenarios, each with its road network.

    Raises:
        NoRoute: An ego has no route.
    """
    if space.vehicles:
        yield from _speed_notes(space, seeds)
        yield from _acceleration_notes(space)
    yield from _delay_notes(space, seeds)


def agent_notes(
    agent: AgentChoice | None, seeds: Sequence[tuple[Scenario, RoadNetwork]]
) -> list[str]:
    """Returns notes on speeds among the parameters of the campaign's own agent.

    Args:
        agent: The agent; ``None``: the seed scenarios have theirs.
        seeds: The seed scenarios, each with its road network.
    """
    if agent is None:
        return []
    found = (
        [*wanted_speed_notes(("agent", "parameters"), agent.parameters, egos, network)]
        for egos, network in ((scenario.ego_vehicles, network) for scenario, network in seeds)
    )
    # Those of other seed scenarios say the same.
    return next((notes for notes in found if notes), [])


def note_in_campaign(note: str, number: int | None, name: str) -> str:
    """Returns a note on a seed scenario as one on the campaign.

    Args:
        note: The note; it may begin with a JSON pointer.
        number: Place among several seed scenarios; ``None``: it is the only one.
        name: Name of the seed scenario, where there are several.
    """
    if note.startswith("/"):
        place = "/scenario" if number is None else f"/scenarios/{number}/scenario"
        return f"{place}{note}"
    return note if number is None else f"{name}: {note}"


def _speed_notes(
    space: SpaceDocument, seeds: Sequence[tuple[Scenario, RoadNetwork]]
) -> Iterator[str]:
    found = (
        limit_near(network, place.x, place.y)
        for scenario, network in seeds
        for ego in scenario.ego_vehicles
        for place in (ego.route[0], ego.route[-1])
    )
    limits = [limit for limit in found if limit is not None]
    if not limits:
        return
    limit = max(limits)
    if space.min_speed > limit:
        yield placed(
            ("space", "min_speed"),
            f"every NPC vehicle wants {speed_words(space.min_speed)} or more; the lanes at the "
            f"egos' starts and destinations allow {speed_words(limit)} at most; "
            f"{other_unit(space.min_speed)}",
        )
    if space.max_speed_factor > FAST_FACTOR:
        yield placed(
            ("space", "max_speed_factor"),
            f"NPC vehicles want up to {space.max_speed_factor:g} times the speed limit: "
            f"{speed_words(space.max_speed_factor * limit)} where {speed_words(limit)} are allowed",
        )


def _acceleration_notes(space: SpaceDocument) -> Iterator[str]:
    for name in ("max_deceleration", "max_lateral_acceleration"):
        value = getattr(space, name)
        if value > GRAVITY:
            yield placed(
                ("space", name),
                f"{value:g} m/s²; a dry road allows {GRAVITY:g} m/s², and vehicles use no more",
            )


def _delay_notes(
    space: SpaceDocument, seeds: Sequence[tuple[Scenario, RoadNetwork]]
) -> Iterator[str]:
    end = max(latest_end(scenario, network) for scenario, network in seeds)
    for name, value, varies, what in (
        ("max_walker_delay", space.max_walker_delay, space.walkers > 0, "walkers"),
        ("max_ego_delay", space.max_ego_delay, space.egos > 1, "egos"),
        ("slice_time", space.slice_time, space.vehicles > 0, "a vehicle in its first slice"),
    ):
        if varies and value >= end:
            yield placed(
                ("space", name),
                f"{duration_words(value)} for {what}; every run has ended by {end:.0f} s; times "
                "are in seconds",
            )
