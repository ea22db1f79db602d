"""scene_obs: the published form of a trace, one frame for each step.

A frame is JSON-able: ``step``, ``timestamp`` (s), ``egos``, ``other_actors`` (``vehicles``,
``walkers``, ``obstacles``, ``background``, ``traffic_lights``) and ``agent_logs``. Positions are
box centres in metres in the network's plane, velocities m/s, accelerations m/s²; angles are degrees
counter-clockwise from east, as in scenario documents. Numbers are rounded to six decimals; the
trace file has them in full. Unknown and inapplicable values are null.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivora_service.observations.trace import Actor, Col, EgoCol, Light, Role, Trace

_DECIMALS = 6
_GROUPS = {
    Role.NPC_VEHICLE: "vehicles",
    Role.NPC_WALKER: "walkers",
    Role.NPC_OBSTACLE: "obstacles",
    Role.BACKGROUND: "background",
}
_KINDS = {
    Role.EGO: "vehicle",
    Role.NPC_VEHICLE: "vehicle",
    Role.NPC_WALKER: "walker",
    Role.NPC_OBSTACLE: "obstacle",
    Role.BACKGROUND: "vehicle",
}
_BLOCK = 256


def ndjson(trace: Trace, first: int, last: int) -> Iterator[bytes]:
    """Yields the frames of rows ``first`` to ``last`` (exclusive), each as a line of JSON."""
    encode = json.JSONEncoder(separators=(",", ":"), allow_nan=False, check_circular=False).encode
    for frame in scene_frames(trace, first, last):
        yield encode(frame).encode() + b"\n"


def scene_frames(trace: Trace, first: int, last: int) -> Iterator[dict[str, Any]]:
    """Yields the frames of rows ``first`` to ``last`` (exclusive), as far as the trace has them.

    Egos are listed at every step, other actors while they are present.
    """
    last = min(last, trace.step_count)
    events: dict[int, list[tuple[int, str]]] = {}
    for event in trace.log_events:
        events.setdefault(event.step, []).append((event.ego, event.message))
    for start in range(max(first, 0), last, _BLOCK):
        yield from _frames(trace, start, min(start + _BLOCK, last), events)


def _frames(
    trace: Trace, first: int, last: int, events: dict[int, list[tuple[int, str]]]
) -> Iterator[dict[str, Any]]:
    """Returns the frames of a block of rows: arrays are converted to lists once for each block."""
    rows = slice(first, last)
    times = _numbers(trace.times[rows])
    states = _numbers(_in_degrees(trace.states[rows], (Col.YAW, Col.YAW_RATE)))
    present = trace.present[rows].tolist()
    values = _numbers(_in_degrees(trace.ego_values[rows], (EgoCol.STEER, EgoCol.LANE_HEADING)))
    lanes = trace.ego_lanes[rows].tolist()
    lights = trace.ego_lights[rows].tolist()
    signals = trace.light_states[rows].tolist()
    logs = _numbers(trace.log_values[rows])
    egos = trace.actors[: trace.ego_count]
    others = trace.actors[trace.ego_count :]

    for k in range(last - first):
        groups: dict[str, list[Any]] = {name: [] for name in _GROUPS.values()}
        for actor in others:
            if present[k][actor.row]:
                groups[_GROUPS[actor.role]].append(_actor(actor, states[k][actor.row]))
        frame_egos, agent_logs = [], {}
        for ego in egos:
            row = ego.row
            frame_egos.append(
                {
                    **_actor(ego, states[k][row]),
                    **_ego(values[k][row], trace.lane_ids, lanes[k][row], lights[k][row]),
                }
            )
            said = [message for ego_row, message in events.get(first + k, ()) if ego_row == row]
            agent_logs[ego.id] = {
                "values": dict(zip(trace.log_names, logs[k][row], strict=True)),
                "events": said,
            }
        groups["traffic_lights"] = [
            {"id": light, "state": trace.light_state_names[state]}
            for light, state in zip(trace.light_ids, signals[k], strict=True)
        ]
        yield {
            "step": first + k,
            "timestamp": times[k],
            "egos": frame_egos,
            "other_actors": groups,
            "agent_logs": agent_logs,
        }


def _actor(actor: Actor, state: list[float | None]) -> dict[str, Any]:
    x, y, yaw, vx, vy, ax, ay, yaw_rate, z = state
    return {
        "id": actor.id,
        "kind": _KINDS[actor.role],
        "model": actor.model,
        "position": {"x": x, "y": y, "z": z},
        "yaw": yaw,
        "velocity": {"x": vx, "y": vy},
        "acceleration": {"x": ax, "y": ay},
        "yaw_rate": yaw_rate,
        "size": {"length": actor.length, "width": actor.width},
    }


def _ego(
    values: list[float | None], lane_ids: dict[int, str], lane: int, light: int
) -> dict[str, Any]:
    acceleration, steer, route_s, route_lateral, limit, lateral, heading, distance = values
    on_lane = {
        "index": lane,
        "id": lane_ids.get(lane),
        "lateral": lateral,
        "heading": heading,
    }
    return {
        "control": {"acceleration": acceleration, "steer": steer},
        "lane": None if lane < 0 else on_lane,
        "speed_limit": limit,
        "route": {"distance": route_s, "lateral": route_lateral},
        "light": None
        if light == Light.NONE
        else {"state": Light(light).name.lower(), "distance": distance},
    }


def _in_degrees(values: NDArray[np.float64], columns: tuple[int, ...]) -> NDArray[np.float64]:
    converted = values.copy()
    for column in columns:
        converted[..., column] = np.degrees(converted[..., column])
    return converted


def _numbers(values: NDArray[np.float64]) -> Any:
    """Returns nested lists of rounded numbers, with ``None`` for values that are not finite."""
    rounded = np.round(values, _DECIMALS)
    finite = np.isfinite(rounded)
    if finite.all():
        return rounded.tolist()
    numbers = rounded.astype(object)
    numbers[~finite] = None
    return numbers.tolist()
