"""Differences of two traces apart from their rows: network, scenario, actors, routes."""

from __future__ import annotations

import hashlib
from collections.abc import Collection, Iterator
from dataclasses import dataclass

import numpy as np

from drivora_service.observations.trace import EgoRoute, Trace
from drivora_service.shapes import Shape

_OF_TRACE = ("network", "network_sha256", "scenario_sha256", "step_length", "max_sim_time")
_LISTS = ("light_ids", "light_state_names", "log_names")
_OF_ACTOR = ("role", "model", "length", "width")
_DIGITS = 12
"""Of the hash that tells two routes of the same length apart."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FactDifference(Shape):
    """Something that holds for a whole trace, and differs between two.

    Attributes:
        fact: Name of it.
        original: Value in the original; "none" if it has none.
        replayed: Value in the other trace, likewise.
    """

    fact: str
    original: str
    replayed: str


def fact_differences(original: Trace, replayed: Trace) -> tuple[FactDifference, ...]:
    """Returns what differs between two traces apart from rows and events.

    An actor that only one of them has is none of these if it is present in any row.
    """
    common = {actor.id for actor in original.actors} & {actor.id for actor in replayed.actors}
    before, after = dict(_facts(original, common)), dict(_facts(replayed, common))
    return tuple(
        FactDifference(
            fact=fact, original=before.get(fact, "none"), replayed=after.get(fact, "none")
        )
        for fact in dict.fromkeys((*before, *after))
        if before.get(fact) != after.get(fact)
    )


def _facts(trace: Trace, common: Collection[str]) -> Iterator[tuple[str, str]]:
    """Yields the facts of a trace by name; ``common`` are the ids of actors that both have."""
    for name in _OF_TRACE:
        yield name, str(getattr(trace, name))
    for name in _LISTS:
        yield name, ", ".join(getattr(trace, name))
    yield "order of actors", ", ".join(actor.id for actor in trace.actors if actor.id in common)
    for actor in trace.actors:
        if actor.id in common:
            for name in _OF_ACTOR:
                yield f"{name} of {actor.id}", str(getattr(actor, name))
        elif not trace.present[:, actor.row].any():
            yield f"presence of {actor.id}", "never"
    for ego, route in enumerate(trace.ego_routes):
        name = trace.actors[ego].id
        yield f"start_time of {name}", str(trace.ego_start_times[ego])
        yield f"privileged of {name}", str(trace.privileged[ego])
        yield f"route of {name}", _route(route)


def _route(route: EgoRoute) -> str:
    points = np.concatenate([route.line.ravel(), route.arc, (route.length, *route.goal)])
    # Zeros of either sign are the same number.
    digest = hashlib.sha256((points + 0.0).tobytes()).hexdigest()
    return f"{len(route.line)} points, {route.length} m, sha256 {digest[:_DIGITS]}"
