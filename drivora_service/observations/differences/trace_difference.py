"""The first difference of two traces: frame, actor and signal, exactly.

Two traces have a difference exactly if their hashes differ (:mod:`trace_hash`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from drivora_service.geometry.array_shapes import BoolArray
from drivora_service.observations.differences.compared_signals import (
    ComparedSignals,
    Value,
    collect_events,
    compared_signals,
)
from drivora_service.observations.differences.fact_differences import (
    FactDifference,
    fact_differences,
)
from drivora_service.observations.trace import Trace
from drivora_service.shapes import Shape


@dataclass(frozen=True, slots=True, kw_only=True)
class SignalDifference(Shape):
    """A signal that differs in a frame.

    Attributes:
        actor: Id of the actor or traffic light; empty for the whole trace.
        signal: Name of the signal.
        original: Value in the original; null: not present or not applicable.
        replayed: Value in the other trace, likewise.
    """

    actor: str
    signal: str
    original: Value
    replayed: Value


@dataclass(frozen=True, slots=True, kw_only=True)
class TraceDifference(Shape):
    """The difference of two traces.

    Attributes:
        step: First row that differs; null if no row does, but ``facts`` do.
        time: Simulation time of that row, seconds.
        signals: What differs in that row, causes before effects: time, presence and states of
            actors, traffic lights, what is measured of egos, logs and commands of agents, events.
        facts: What differs apart from rows, such as the hash of the road network.
    """

    step: int | None
    time: float | None
    signals: tuple[SignalDifference, ...]
    facts: tuple[FactDifference, ...]


def trace_difference(original: Trace, replayed: Trace) -> TraceDifference | None:
    """Returns the difference of two traces; ``None`` if they are the same, bit for bit.

    Covered is what the hash of a trace covers. As there, the bits of NaNs, the sign of zeros and
    the states of actors that are not present do not count.
    """
    facts = fact_differences(original, replayed)
    signals = [(one, one.unequal()) for one in compared_signals(original, replayed)]
    firsts = [int(rows.argmax()) for rows in (u.any(axis=(1, 2)) for _, u in signals) if rows.any()]
    before, after = collect_events(original), collect_events(replayed)
    changed = [place for place in before | after if before.get(place) != after.get(place)]
    firsts += [place.step for place in changed]
    lengths = original.step_count, replayed.step_count
    if lengths[0] != lengths[1]:
        firsts.append(min(lengths))
    if not firsts:
        return TraceDifference(step=None, time=None, signals=(), facts=facts) if facts else None
    step = min(firsts)
    found = [one for group, unequal in signals for one in _in_row(group, unequal, step)]
    found += [
        SignalDifference(
            actor=place.actor,
            signal=place.signal,
            original=before.get(place),
            replayed=after.get(place),
        )
        for place in changed
        if place.step == step
    ]
    if lengths[0] != lengths[1] and step == min(lengths):
        found.append(
            SignalDifference(actor="", signal="steps", original=lengths[0], replayed=lengths[1])
        )
    longer = max(original, replayed, key=lambda trace: trace.step_count)
    time = float(longer.times[step]) if step < longer.step_count else None
    return TraceDifference(step=step, time=time, signals=tuple(found), facts=facts)


def _in_row(group: ComparedSignals, unequal: BoolArray, step: int) -> Iterator[SignalDifference]:
    if step >= len(unequal):
        return
    for actor, signal in np.argwhere(unequal[step]).tolist():
        place = (step, actor, signal)
        yield SignalDifference(
            actor=group.actors[actor],
            signal=group.names[signal],
            original=group.value(group.original[place]),
            replayed=group.value(group.replayed[place]),
        )
