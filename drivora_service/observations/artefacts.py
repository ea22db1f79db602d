"""Contacts that the simulator made: no motion of the two actors led to them.

SUMO's LC2013 changes lanes within one step, and a vehicle may enter where another one is. Such a
contact says nothing about the driving of the ego that was touched, and what follows it says nothing
either: the part of that ego ends, for judging, with the row before.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.observations.trace import Actor, Col, Contact, Trace

JUMP = 1.0
"""Metres in one step beyond what the speeds of an actor explain. Braking and steering explain
centimetres, a change to the next lane in one step takes metres."""


class ArtefactKind(StrEnum):
    """How an actor came to where it touched the ego."""

    APPEARED = "appeared"
    """It was not there a step before."""
    ENTERED = "entered"
    """The ego itself was not there a step before."""
    JUMPED = "jumped"
    """It was moved further in one step than its speeds explain."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Artefact:
    """A contact that the simulator made.

    Attributes:
        step: Row of the trace at the contact.
        other: The actor that touches the ego.
        kind: How it came there.
        distance: Metres that it was moved in the last step; 0 unless it jumped.
    """

    step: int
    other: Actor
    kind: ArtefactKind
    distance: float = 0.0

    @property
    def in_words(self) -> str:
        """What the simulator did, as a clause."""
        match self.kind:
            case ArtefactKind.APPEARED:
                return f"{self.other.id} appeared where the ego was"
            case ArtefactKind.ENTERED:
                return f"the ego appeared where {self.other.id} was"
            case ArtefactKind.JUMPED:
                return (
                    f"{self.other.id} jumped into the ego, {self.distance:.1f} m in one step, "
                    "which its speed does not explain"
                )


def find_artefact(trace: Trace, ego: int, other: int, step: int) -> Artefact | None:
    """Returns what the simulator did to make a contact; ``None`` if motion led to it.

    Args:
        trace: The run.
        ego: Row of the ego.
        other: Row of the other actor.
        step: Row of the trace at the contact. What overlaps in the first row of a record was
            placed so by the scenario.
    """
    actor = trace.actors[other]
    if step == 0:
        return None
    if not trace.present[step - 1, ego]:
        return Artefact(step=step, other=actor, kind=ArtefactKind.ENTERED)
    if not trace.present[step - 1, other]:
        return Artefact(step=step, other=actor, kind=ArtefactKind.APPEARED)
    before, after = trace.states[step - 1, other], trace.states[step, other]
    if not has_jumped(before, after, trace.step_length):
        return None
    distance = float(np.hypot(*(after - before)[[Col.X, Col.Y]]))
    return Artefact(step=step, other=actor, kind=ArtefactKind.JUMPED, distance=distance)


def has_jumped(before: FloatArray, after: FloatArray, step_length: float) -> bool:
    """Returns whether an actor's displacement disagrees with its speeds before and after a step.

    Any speed between the two explains it: a vehicle that crashed stands from one row to the next.

    Args:
        before: (9,) columns ``Col``.
        after: (9,) a step later.
        step_length: Seconds.
    """
    moved = (after - before)[[Col.X, Col.Y]]
    first, last = (state[[Col.VX, Col.VY]] * step_length for state in (before, after))
    change = last - first
    span = float((change * change).sum())
    along = float(((moved - first) * change).sum())
    share = 0.0 if span == 0.0 else min(max(along / span, 0.0), 1.0)
    return bool(np.hypot(*(moved - first - share * change)) > JUMP)


def spoiling_artefact(trace: Trace, ego: int, first: int, stop: int) -> Artefact | None:
    """Returns the artefact with which a part of an ego ends for judging, or ``None``.

    It is one if no earlier contact, and none in the same row, is the work of the actors: such a
    collision counts.

    Args:
        trace: The run.
        ego: Row of the ego.
        first: Row of the trace with which its part begins.
        stop: Row after the last.
    """
    met = [
        (contact.step, other)
        for contact in trace.contacts
        if first <= contact.step < stop and (other := counterpart(contact, ego)) is not None
    ]
    if not met:
        return None
    soonest = min(step for step, _ in met)
    found = [find_artefact(trace, ego, other, step) for step, other in met if step == soonest]
    return None if None in found else found[0]


def counterpart(contact: Contact, row: int) -> int | None:
    """Returns the row of the actor that a contact of the actor in ``row`` is with, or ``None``."""
    if contact.ego == row:
        return contact.other
    return contact.ego if contact.other == row else None
