"""A conflict of an ego with an actor that has the right of way."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class Conflict:
    """A conflict in which an ego went before an actor that has the right of way.

    Attributes:
        row: Row of the ego at which it took the right of way.
        other: Row of the actor in the trace.
        lag: Seconds from the ego's leaving a place to the other's reaching it; inf if never.
        braking: m/s² of the other's braking because of the ego.
        place: "junction" or "crossing".
        braked: Row of the trace in which it brakes hardest because of the ego; -1 if it does not.
    """

    row: int
    other: int
    lag: float
    braking: float
    place: str
    braked: int = -1
