"""The signals of two traces side by side, in the rows that both have.

Actors, traffic lights and log columns are matched by their names: the rows of actors that appear
during a run depend on what happened before. Signals are named as the columns of the trace file,
and besides ``time``, ``present``, ``state`` of a traffic light, ``log line``, ``contact``, ``end``.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivora_service.geometry.array_shapes import BoolArray
from drivora_service.observations.trace import Col, EgoCol, Light, Trace

Value = float | int | str | bool | None
"""A value of a signal; ``None`` is "not present" or "not applicable"."""

_COMMANDS = (EgoCol.ACCELERATION, EgoCol.STEER)
_MEASURED = tuple(column for column in EgoCol if column not in _COMMANDS)
_LIGHTS = {light.value: light.name.lower() for light in Light}
_NONE = -1
"""Index of no lane, and of the state of a traffic light that a trace does not have."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ComparedSignals:
    """The same signals of several actors in two traces.

    Attributes:
        actors: n ids.
        names: s names of the signals.
        original: (T, n, s) values in the rows that both traces have.
        replayed: (T, n, s) likewise.
        ignored: (T, n) flags of places that are not compared; ``None``: all are.
        value: Converts an element to a value.
    """

    actors: Sequence[str]
    names: Sequence[str]
    original: NDArray[Any]
    replayed: NDArray[Any]
    ignored: BoolArray | None = None
    value: Callable[[Any], Value]

    def unequal(self) -> BoolArray:
        """Returns the (T, n, s) flags of values that differ; NaN equals NaN."""
        # What differs from itself is NaN.
        known = (self.original == self.original) | (self.replayed == self.replayed)
        differ: BoolArray = (self.original != self.replayed) & known
        return differ if self.ignored is None else differ & ~self.ignored[:, :, np.newaxis]


class EventPlace(NamedTuple):
    """The place of an event in a trace."""

    step: int
    actor: str
    signal: str


def compared_signals(original: Trace, replayed: Trace) -> list[ComparedSignals]:
    """Returns all signals that have a value in every row, causes before effects.

    An agent answers to what is there in the same row; states follow from the commands of the row
    before.
    """
    rows = min(original.step_count, replayed.step_count)
    both = (original, replayed)
    return [
        _times(both, rows),
        *_states(both, rows),
        _lights(both, rows),
        *_egos(both, rows),
    ]


def collect_events(trace: Trace) -> dict[EventPlace, str]:
    """Returns what happened in single rows: log lines, first contacts, ends of egos."""
    found: dict[EventPlace, list[str]] = {}

    def add(step: int, ego: int, signal: str, text: str) -> None:
        found.setdefault(EventPlace(int(step), trace.actors[ego].id, signal), []).append(text)

    for line in trace.log_events:
        add(line.step, line.ego, "log line", line.message)
    for contact in trace.contacts:
        add(contact.step, contact.ego, "contact", trace.actors[contact.other].id)
    for ego, (step, end) in enumerate(zip(trace.ego_end_steps, trace.ego_ends, strict=True)):
        add(step, ego, "end", end)
    return {place: "\n".join(texts) for place, texts in found.items()}


_Both = tuple[Trace, Trace]


def _times(both: _Both, rows: int) -> ComparedSignals:
    times = [trace.times[:rows, np.newaxis, np.newaxis] for trace in both]
    return ComparedSignals(
        actors=("",), names=("time",), original=times[0], replayed=times[1], value=_number
    )


def _states(both: _Both, rows: int) -> tuple[ComparedSignals, ComparedSignals]:
    """Returns the presence and the states of all actors."""
    ids = [[actor.id for actor in trace.actors] for trace in both]
    every = _union(*ids)
    present = [
        _align(trace.present[:rows], names, every, missing=False)
        for trace, names in zip(both, ids, strict=True)
    ]
    states = [
        _align(trace.states[:rows], names, every, missing=np.nan)
        for trace, names in zip(both, ids, strict=True)
    ]
    return (
        ComparedSignals(
            actors=every,
            names=("present",),
            original=present[0][:, :, np.newaxis],
            replayed=present[1][:, :, np.newaxis],
            value=bool,
        ),
        ComparedSignals(
            actors=every,
            names=[column.name.lower() for column in Col],
            original=states[0],
            replayed=states[1],
            ignored=~(present[0] & present[1]),
            value=_number,
        ),
    )


def _lights(both: _Both, rows: int) -> ComparedSignals:
    every = _union(*(trace.light_ids for trace in both))
    shown = _union(*(trace.light_state_names for trace in both))
    codes = []
    for trace in both:
        own = np.array([shown.index(name) for name in trace.light_state_names], dtype=np.int64)
        states = own[trace.light_states[:rows]] if len(own) else trace.light_states[:rows]
        codes.append(_align(states, trace.light_ids, every, missing=_NONE)[:, :, np.newaxis])
    return ComparedSignals(
        actors=every,
        names=("state",),
        original=codes[0],
        replayed=codes[1],
        value=lambda code: None if code == _NONE else shown[code],
    )


def _egos(both: _Both, rows: int) -> list[ComparedSignals]:
    """Returns what is recorded of egos only; egos that one trace lacks are no signals."""
    ids = [[actor.id for actor in trace.actors[: trace.ego_count]] for trace in both]
    common = [ego for ego in ids[0] if ego in ids[1]]
    logs = _union(*(trace.log_names for trace in both))

    def make_signals(
        names: Sequence[str], values: Callable[[Trace], NDArray[Any]], value: Callable[[Any], Value]
    ) -> ComparedSignals:
        original, replayed = (
            _align(values(trace)[:rows], own, common) for trace, own in zip(both, ids, strict=True)
        )
        return ComparedSignals(
            actors=common, names=names, original=original, replayed=replayed, value=value
        )

    def columns(chosen: Sequence[EgoCol]) -> ComparedSignals:
        return make_signals(
            [f"ego_{column.name.lower()}" for column in chosen],
            lambda trace: trace.ego_values[:, :, list(chosen)],
            _number,
        )

    def align_log(trace: Trace) -> NDArray[Any]:
        by_log = np.moveaxis(trace.log_values, 2, 1)
        matched = _align(by_log, trace.log_names, logs, missing=np.nan)
        return np.moveaxis(matched, 1, 2)

    return [
        columns(_MEASURED),
        make_signals(("lane",), lambda trace: trace.ego_lanes[:, :, np.newaxis], _lane),
        make_signals(("light",), lambda trace: trace.ego_lights[:, :, np.newaxis], _light),
        make_signals([f"log:{name}" for name in logs], align_log, _number),
        columns(_COMMANDS),
    ]


def _align(
    values: NDArray[Any], names: Sequence[str], wanted: Sequence[str], *, missing: Any = 0
) -> NDArray[Any]:
    """Returns values (T, n, …) in the order of other names; those that are not there are filled."""
    places = {name: place for place, name in enumerate(names)}
    known = [place for place, name in enumerate(wanted) if name in places]
    matched = np.full((len(values), len(wanted), *values.shape[2:]), missing, dtype=values.dtype)
    matched[:, known] = values[:, [places[wanted[place]] for place in known]]
    return matched


def _union(first: Sequence[str], second: Sequence[str]) -> list[str]:
    return list(dict.fromkeys((*first, *second)))


def _number(value: np.floating[Any]) -> Value:
    return None if np.isnan(value) else float(value)


def _lane(index: np.integer[Any]) -> Value:
    return None if index == _NONE else int(index)


def _light(code: np.integer[Any]) -> Value:
    # A file may hold any number.
    return _LIGHTS.get(int(code), int(code))
