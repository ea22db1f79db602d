"""Conflicts of an ego with vehicles that have the right of way at junctions."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from drivora_service.networks.projection import project_points
from drivora_service.networks.right_of_way import right_of_way
from drivora_service.networks.stop_lines import WayThrough
from drivora_service.observations.awaited_line import awaited_ways
from drivora_service.observations.leaders import VEHICLES
from drivora_service.observations.line_crossings import Crossing
from drivora_service.observations.recorded_signals import signal_letter
from drivora_service.observations.run_view import EgoView
from drivora_service.observations.trace import Col
from drivora_service.observations.yielding.conflict import Conflict
from drivora_service.observations.yielding.encroachment import least_lag
from drivora_service.observations.yielding.hindrance import Passage, hindered_braking

_NEAR = 80.0
"""Radius around the ego in which others are considered, metres."""

_RED = ("r", "u")
"""SUMO's letters of a red signal."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Foes:
    """The movements through a junction that go before an ego.

    Attributes:
        lanes: Their lanes inside the junction.
        junction: All lanes inside the junction.
        incoming: The lanes from which they come.
    """

    lanes: frozenset[int]
    junction: frozenset[int]
    incoming: frozenset[int]


def vehicle_conflicts(ego: EgoView, *, attention: float) -> Iterator[Conflict]:
    """Finds the vehicles with the right of way that the ego went before at junctions.

    Args:
        ego: The ego.
        attention: Seconds after the ego's passage within which others count.
    """
    if not ego.network.path.is_file():
        # SUMO's table of the right of way is in the network's file.
        return
    for crossing in ego.crossings:
        foes = _foes_of_all_ways(ego, crossing)
        if not foes.lanes:
            continue
        leaves = leaving_row(ego, crossing)
        last = min(leaves + round(attention / ego.step_length), ego.count - 1)
        for actor in ego.trace.actors:
            if actor.row == ego.row or actor.role not in VEHICLES:
                continue
            if not _drives_on(ego, actor.row, crossing.front, last, foes):
                continue
            lag = least_lag(ego, actor.row, crossing.front, leaves, last)
            passage = Passage(first=crossing.front, leaves=leaves, last=last)
            braking, braked = hindered_braking(ego, actor.row, passage, foes.lanes)
            if math.isfinite(lag) or braking > 0.0:
                yield Conflict(
                    row=crossing.front,
                    other=actor.row,
                    lag=lag,
                    braking=braking,
                    place="junction",
                    braked=braked,
                )


def gives_way_to_vehicles(ego: EgoView) -> bool:
    """Returns whether some vehicles go before the ego at a junction that it came to.

    It crossed the stop line, or was at the line when its part ended.
    """
    if not ego.network.path.is_file():
        return False
    return any(_foes_of_all_ways(ego, crossing).lanes for crossing in ego.crossings) or any(
        _foes(ego, ego.count - 1, way).lanes for way in awaited_ways(ego)
    )


def _foes_of_all_ways(ego: EgoView, crossing: Crossing) -> _Foes:
    """Returns the movements that go before the ego, whichever way it was taking.

    An ego whose part ends soon after the line may have been on one of several ways.
    """
    found = [_foes(ego, crossing.front, way) for way in crossing.ways]
    if not found or not all(way.inside for way in crossing.ways):
        return _Foes(lanes=frozenset(), junction=frozenset(), incoming=frozenset())
    return _Foes(
        lanes=frozenset.intersection(*(foes.lanes for foes in found)),
        junction=frozenset.union(*(foes.junction for foes in found)),
        incoming=frozenset.intersection(*(foes.incoming for foes in found)),
    )


def _foes(ego: EgoView, row: int, way: WayThrough) -> _Foes:
    """Returns the movements that go before one of the ego's ways through a junction.

    Args:
        ego: The ego.
        row: Its row in which it passes the line, whose signals count.
        way: The way.
    """
    letter = signal_letter(ego, way.connection, row)
    table = right_of_way(ego.network)
    own = next((table.by_lane[lane] for lane in way.inside if lane in table.by_lane), None)
    lanes: set[int] = set()
    incoming: set[int] = set()
    if own is not None and (letter is None or letter in "gru"):
        # On red, whatever crosses on green goes first.
        for lane in own.yields_to if letter is None or letter == "g" else own.foes:
            foe = table.by_lane.get(lane)
            if foe is None or (letter not in _RED and own.lanes[-1] in foe.yields_to):
                continue
            if letter is not None and not _may_go(ego, foe.incoming, foe.lanes, row):
                continue
            lanes.update(foe.lanes)
            incoming.add(foe.incoming)
    junction = own.junction if own is not None else ""
    return _Foes(
        lanes=frozenset(lanes),
        junction=frozenset(
            lane for lane, movement in table.by_lane.items() if movement.junction == junction
        ),
        incoming=frozenset(incoming),
    )


def _may_go(ego: EgoView, incoming: int, lanes: tuple[int, ...], row: int) -> bool:
    """Returns whether the signal of a movement is green."""
    if incoming < 0:
        return False
    for connection in ego.network.lanes[incoming].connections:
        if connection.to_lane in lanes:
            letter = signal_letter(ego, connection, row)
            return letter is None or letter in "Gg"
    return False


def leaving_row(ego: EgoView, crossing: Crossing) -> int:
    """Returns the first row of an ego after the junction behind a line, or its last one."""
    inside = np.isin(ego.lanes, [lane for way in crossing.ways for lane in way.inside])
    inside[: crossing.front] = False
    rows = np.flatnonzero(inside)
    if not len(rows):
        return min(crossing.front + 1, ego.count - 1)
    behind = rows[-1] + 1
    length = ego.actor.length
    way_driven = np.cumsum(ego.moved)
    clear = np.flatnonzero(way_driven >= way_driven[min(behind, ego.count - 1)] + 0.5 * length)
    return int(clear[0]) if len(clear) else ego.count - 1


def _drives_on(ego: EgoView, other: int, first: int, last: int, foes: _Foes) -> bool:
    """Returns whether an actor near the ego in some rows drives a movement that goes first.

    One that has to stop before the junction comes onto its way later, and one that swerves round
    the ego may leave it: then the lane counts on which it came up.

    Args:
        ego: The ego.
        other: Row of the actor in the trace.
        first: The ego's row in which it came into the junction.
        last: The ego's last row that counts.
        foes: The movements that go before the ego.
    """
    rows = slice(ego.first + first, ego.first + last + 1)
    states = ego.trace.states[rows, other]
    away = np.hypot(
        states[:, Col.X] - ego.states[first : last + 1, Col.X],
        states[:, Col.Y] - ego.states[first : last + 1, Col.Y],
    )
    near = np.flatnonzero(ego.trace.present[rows, other] & (away < _NEAR))
    if not len(near):
        return False
    onwards = slice(ego.first + first + int(near[0]), None)
    states = ego.trace.states[onwards, other][ego.trace.present[onwards, other]]
    found = project_points(
        ego.network, states[:, [Col.X, Col.Y]].copy(), np.ascontiguousarray(states[:, Col.YAW])
    )
    lanes = found.lane.tolist()
    entered = next((k for k, lane in enumerate(lanes) if lane in foes.junction), None)
    if entered is not None:
        # Ways lie over each other where they begin: the last lane of the passage tells them apart,
        # or most of it where an actor swerves at its end.
        left = next(
            (k for k in range(entered, len(lanes)) if lanes[k] not in foes.junction), len(lanes)
        )
        on_way = [lane in foes.lanes for lane in lanes[entered:left]]
        if on_way[-1] or 2 * sum(on_way) > len(on_way):
            return True
    came_up = lanes[0] in foes.incoming
    if entered is None:
        # Round the ego it was beside all ways through the junction.
        return came_up and any(lane < 0 for lane in lanes)
    # Its own lane before the junction is another one than that on which it came up.
    return came_up and lanes[max(entered - 1, 0)] != lanes[0]
