"""Later starts: scenarios that begin where a recorded run was a few seconds before its failure.

Every actor starts at the place and speed that it had then, the waypoints behind it are left out,
and all times are that much earlier. What an agent remembers, and the places of the background
traffic, cannot be carried over: a later start is taken only if its run fails in the same way.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.observations.trace import Col, Trace
from drivora_service.scenario.documents import ScenarioDocument
from drivora_service.scenario.entities import PlaceDocument
from drivora_service.suites.minimization.edits import REMOVED, Edit, Place
from drivora_service.suites.minimization.removals import ACTORS

BEFORE_S = (2.0, 5.0, 10.0, 20.0)
"""Seconds before the failure at which a scenario may begin."""
_LEAST_S = 1.0
"""Seconds by which a scenario must become shorter."""
_BEHIND_M = 0.5
"""Metres from a waypoint within which it counts as passed."""

Change = tuple[Place, Any]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Recording:
    """The motions of all actors of a run.

    Attributes:
        times: (n,) seconds.
        states: (n, 4) x, y, heading and speed of each actor by its id; metres, radians, m/s; NaN
            where it is not present.
        has_lights: Whether there are traffic lights.
    """

    times: FloatArray
    states: Mapping[str, FloatArray]
    has_lights: bool

    def at(self, actor: str, time: float) -> tuple[float, float, float, float] | None:
        """Returns x, y, heading and speed of an actor; ``None`` if it is not present."""
        row = int(np.searchsorted(self.times, time - 1e-6))
        if actor not in self.states or row >= len(self.times):
            return None
        x, y, yaw, speed = self.states[actor][row].tolist()
        return (x, y, yaw, speed) if math.isfinite(x) else None


def recording_of(trace: Trace) -> Recording:
    """Returns the motions of a recorded run."""
    states = {}
    for actor in trace.actors:
        motion = trace.states[:, actor.row][:, [Col.X, Col.Y, Col.YAW, Col.VX]].copy()
        velocity = trace.states[:, actor.row][:, [Col.VX, Col.VY]]
        motion[:, 3] = np.hypot(*velocity.T)
        motion[~trace.present[:, actor.row]] = np.nan
        states[actor.id] = motion
    return Recording(times=trace.times, states=states, has_lights=bool(trace.light_ids))


def later_starts(
    document: ScenarioDocument, recording: Recording, failed_at: float
) -> list[list[Edit]]:
    """Returns beginnings of a scenario that are nearer to its failure, the nearest first.

    Args:
        document: The scenario.
        recording: Its run.
        failed_at: Simulation time of the failure, seconds.
    """
    found = []
    for seconds in BEFORE_S:
        begin = round(failed_at - seconds, 1)
        if begin < _LEAST_S:
            break
        changes = tuple(_changes(document, recording, begin))
        label = f"begins {begin:g} s later"
        found.append(Edit(changes=changes, label=label))
        if recording.has_lights:
            # SUMO shows the second `t - offset` of a programme at the time t.
            offset = (document.traffic_lights.offset or 0.0) - begin
            shifted: Change = (("traffic_lights", "offset"), round(offset, 1))
            found.append(Edit(changes=(*changes, shifted), label=f"{label}, as do the lights"))
    return [found]


def _changes(document: ScenarioDocument, recording: Recording, begin: float) -> Iterator[Change]:
    for key in ACTORS:
        for index, actor in enumerate(getattr(document, key)):
            here: Place = (key, index)
            if actor.start_time >= begin:
                yield (*here, "start_time"), round(actor.start_time - begin, 2)
            elif key == "npc_obstacles":
                yield (*here, "start_time"), 0.0
            else:
                yield from _make_start_changes(here, actor, recording.at(actor.id, begin))
    yield from _weather(document, begin)
    if document.max_sim_time is not None:
        yield ("max_sim_time",), round(document.max_sim_time - begin, 1)


def _weather(document: ScenarioDocument, begin: float) -> Iterator[Change]:
    """Yields the changes by which the weather is that of the run from a time on."""
    for index, change in enumerate(document.weather_changes):
        here: Place = ("weather_changes", index)
        if change.time > begin:
            yield (*here, "time"), round(change.time - begin, 2)
            continue
        yield ("weather",), change.weather.model_dump(exclude_defaults=True)
        yield here, REMOVED


def _make_start_changes(
    here: Place, actor: Any, state: tuple[float, float, float, float] | None
) -> Iterator[Change]:
    """Yields the changes by which an actor starts in a state; it is left out if it has none."""
    if state is None:
        yield here, REMOVED
        return
    x, y, yaw, speed = state
    start = {"x": round(x, 2), "y": round(y, 2), "yaw": round(math.degrees(yaw), 1)}
    if here[0] == "ego_vehicles":
        yield (*here, "initial_speed"), round(speed, 2)
    elif len(actor.route) > 1:
        start["speed"] = round(speed, 2)
    yield (*here, "start_time"), 0.0
    if here[0] != "ego_vehicles" and actor.joins:
        yield (*here, "joins"), REMOVED
    yield (*here, "route", 0), start
    # An ego keeps its destination, others the place at which they end.
    for number in range(1, min(_count_passed(actor.route, (x, y)), len(actor.route) - 1)):
        yield (*here, "route", number), REMOVED


def _count_passed(route: Sequence[PlaceDocument], place: tuple[float, float]) -> int:
    """Returns the number of waypoints behind a place, by the leg of the route that is nearest."""
    points = np.array([(point.x, point.y) for point in route])
    if len(points) == 1:
        return 1
    starts, legs = points[:-1], np.diff(points, axis=0)
    lengths = np.maximum((legs**2).sum(axis=1), 1e-9)
    along = np.clip(((np.array(place) - starts) * legs).sum(axis=1) / lengths, 0.0, 1.0)
    away = np.hypot(*(starts + along[:, None] * legs - np.array(place)).T)
    leg = int(np.argmin(away))
    left = (1.0 - along[leg]) * math.sqrt(lengths[leg])
    return leg + 2 if left < _BEHIND_M else leg + 1
