"""Recorded signals for an ego, also off its route."""

from __future__ import annotations

import numpy as np
from shapely import LineString, line_locate_point, points

from drivora_service.geometry.array_shapes import BoolArray, ByteArray
from drivora_service.networks.road_network import Connection, RoadNetwork
from drivora_service.observations.run_view import EgoView
from drivora_service.observations.trace import Col, EgoCol, Light, Trace

BESIDE_ROUTE = 8.0
"""Metres from the route from which on an ego is on another road: the recorded next
signal of the route does not apply to it."""

_SHOWN = {"G": Light.GREEN, "g": Light.GREEN, "y": Light.YELLOW, "u": Light.RED, "r": Light.RED}


def signal_shown(ego: EgoView, connection: Connection) -> ByteArray | None:
    """Returns the (n,) ``Light`` of a movement in every row; ``None`` without a signal.

    A signal that is off, by ``simulation.plans.light_programs``, counts as none in that row.
    """
    shown = signal_in_run(ego.trace, connection)
    return None if shown is None else shown[ego.first : ego.first + ego.count]


def signal_in_run(trace: Trace, connection: Connection) -> ByteArray | None:
    """Returns the (T,) ``Light`` of a movement in every row of a trace; see ``signal_shown``."""
    if connection.traffic_light not in trace.light_ids:
        return None
    states = trace.light_states[:, trace.light_ids.index(connection.traffic_light)]
    shown = np.zeros(trace.step_count, dtype=np.uint8)
    for state in np.unique(states).tolist():
        letter = trace.light_state_names[state][connection.link_index]
        shown[states == state] = _SHOWN.get(letter, Light.NONE)
    return shown


def signal_letter(ego: EgoView, connection: Connection, row: int) -> str | None:
    """Returns SUMO's letter of a movement in a row of the ego; ``None`` without a signal."""
    trace = ego.trace
    if connection.traffic_light not in trace.light_ids:
        return None
    column = trace.light_ids.index(connection.traffic_light)
    state = trace.light_states[ego.first + row, column]
    letter: str = trace.light_state_names[state][connection.link_index]
    return letter


def stop_shown(ego: EgoView, connection: Connection) -> BoolArray | None:
    """Returns the (n,) flags of rows with SUMO's "stop, then go"; ``None`` without a signal."""
    trace = ego.trace
    if connection.traffic_light not in trace.light_ids:
        return None
    column = trace.light_ids.index(connection.traffic_light)
    states = trace.light_states[ego.first : ego.first + ego.count, column]
    names = trace.light_state_names
    stops = [name[connection.link_index : connection.link_index + 1] == "s" for name in names]
    shown: BoolArray = np.array(stops, dtype=np.bool_)[states]
    return shown


def off_route(ego: EgoView) -> BoolArray:
    """Returns the (n,) flags of rows in which the ego is on another road than its route's."""
    off: BoolArray = np.abs(ego.value(EgoCol.ROUTE_LATERAL)) > BESIDE_ROUTE
    return off


def waiting_off_route(ego: EgoView, rows: BoolArray, reach: float) -> BoolArray:
    """Returns flags of rows whose next signal on the ego's lane is near and not all green.

    Args:
        ego: The ego.
        rows: (n,) flags of rows to check; the result is False in others.
        reach: Metres from the front bumper to the stop line.
    """
    waiting = np.zeros(ego.count, dtype=np.bool_)
    for index in np.unique(ego.lanes[rows]).tolist():
        if index < 0:
            continue
        here = np.flatnonzero(rows & (ego.lanes == index))
        lane = LineString(ego.network.lanes[index].shape)
        centres = points(ego.states[here, Col.X], ego.states[here, Col.Y])
        room = lane.length - line_locate_point(lane, centres) - 0.5 * ego.actor.length
        for distance, connection in _next_signals(ego.network, index, reach):
            shown = signal_shown(ego, connection)
            if shown is not None:
                near = here[room + distance <= reach]
                waiting[near] |= shown[near] >= Light.YELLOW
    return waiting


def _next_signals(network: RoadNetwork, start: int, reach: float) -> list[tuple[float, Connection]]:
    """Returns the first signals ahead of a lane, with the metres from its end to their line."""
    found = []
    ahead = [(0.0, start)]
    seen = {start}
    while ahead:
        distance, index = ahead.pop()
        connections = network.lanes[index].connections
        signals = [connection for connection in connections if connection.traffic_light]
        found += [(distance, connection) for connection in signals]
        for connection in () if signals else connections:
            following = network.lanes[connection.to_lane]
            further = distance + float(following.arc[-1])
            if following.index not in seen and further <= reach:
                seen.add(following.index)
                ahead.append((further, following.index))
    return found
