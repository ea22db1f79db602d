"""The signals that an ego met: those that were next on its route, and those that it passed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from shapely import LineString, Point

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.networks.road_network import Connection
from drivora_service.networks.stop_lines import StopLines, WayThrough, stop_lines
from drivora_service.observations.recorded_signals import signal_shown
from drivora_service.observations.run_view import EgoView
from drivora_service.observations.trace import EgoCol, Light

_SAME_LINE = 1.0
"""Metres along the route by which one signal's line may move from row to row."""

_NEAR = 6.0
"""Metres between a stop line and the place on the route that is recorded for it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MetSignal:
    """A signal that an ego met.

    Attributes:
        line: Row of ``stop_lines``.
        connection: Movement whose signal it is.
        first: First row of the ego for which it was the next signal; the row of the passage for
            signals off the route.
        last: Last row of the ego for which it was.
        passed: Row of the ego in which its front passed the line; None if it did not.
    """

    line: int
    connection: Connection
    first: int
    last: int
    passed: int | None


def met_signals(ego: EgoView) -> tuple[MetSignal, ...]:
    """Returns the signals that an ego met, in the order of time."""
    lines = stop_lines(ego.network)
    found = [signal for part in _approaches(ego) if (signal := _find_signal(ego, lines, *part))]
    passages = {(signal.line, signal.passed) for signal in found}
    for crossing in ego.crossings:
        if (crossing.line, crossing.front) in passages:
            continue
        ways = crossing.ways or lines.ways[crossing.line]
        signals = [way.connection for way in ways if way.connection.traffic_light]
        if signals:
            front = crossing.front
            found.append(
                MetSignal(
                    line=crossing.line,
                    connection=signals[0],
                    first=front,
                    last=front,
                    passed=front,
                )
            )
    return tuple(sorted(found, key=lambda signal: (signal.first, signal.line)))


def _approaches(ego: EgoView) -> list[tuple[int, int, float]]:
    """Returns first row, last row and place on the route of each signal that was next."""
    place = ego.value(EgoCol.ROUTE_S) + 0.5 * ego.actor.length + ego.value(EgoCol.LIGHT_DISTANCE)
    rows = np.flatnonzero((ego.lights != Light.NONE) & np.isfinite(place))
    if not len(rows):
        return []
    breaks = np.flatnonzero((np.diff(rows) > 1) | (np.abs(np.diff(place[rows])) > _SAME_LINE)) + 1
    return [
        (int(part[0]), int(part[-1]), float(np.median(place[part])))
        for part in np.split(rows, breaks)
    ]


def _find_signal(
    ego: EgoView, lines: StopLines, first: int, last: int, place: float
) -> MetSignal | None:
    """Returns the signal whose stop line is at a place on the route; None if there is none."""
    route = ego.route
    point = np.array([np.interp(place, route.arc, route.line[:, axis]) for axis in (0, 1)])
    # The route may lead past the line on the lane beside it.
    away = np.hypot(*(lines.points - point).T)
    candidates = [
        (float(away[line]), line, way)
        for line in np.flatnonzero(away <= _NEAR).tolist()
        for way in lines.ways[line]
        if way.connection.traffic_light
    ]
    if not candidates:
        return None
    way_line = LineString(route.line)

    def cost(candidate: tuple[float, int, WayThrough]) -> tuple[bool, float]:
        distance, _, way = candidate
        shown = signal_shown(ego, way.connection)
        differs = shown is None or bool(
            (shown[first : last + 1] != ego.lights[first : last + 1]).any()
        )
        return differs, distance + way_line.distance(Point(_middle(ego, way)))

    _, line, way = min(candidates, key=cost)
    passed = next(
        (c.front for c in ego.crossings if c.line == line and first <= c.front <= last + 1), None
    )
    return MetSignal(line=line, connection=way.connection, first=first, last=last, passed=passed)


def _middle(ego: EgoView, way: WayThrough) -> FloatArray:
    """Returns the place half-way through a junction, or at the start of the lane behind it."""
    inside = way.inside[len(way.inside) // 2] if way.inside else way.connection.to_lane
    lane = ego.network.lanes[inside]
    return np.array(lane.position_at(0.5 * float(lane.arc[-1]) if way.inside else 0.0)[:2])
