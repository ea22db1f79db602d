"""Conversion of the static part of a trace to JSON-able data and back."""

from __future__ import annotations

import base64
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivora_service.observations.trace import (
    Actor,
    Contact,
    EgoRoute,
    LogEvent,
    PlannedPath,
    PoseCol,
    Role,
    TerminalEvent,
    Trace,
)


def header_of(trace: Trace) -> dict[str, Any]:
    """Returns the data of a trace without the values of single steps, as JSON-able data.

    It includes the traffic lights, which change so rarely that ``[step, state]`` pairs are enough.
    """
    return {
        "network": trace.network,
        "network_sha256": trace.network_sha256,
        "scenario_sha256": trace.scenario_sha256,
        "step_length": float(trace.step_length),
        "max_sim_time": float(trace.max_sim_time),
        "steps": trace.step_count,
        "actors": [
            {
                "id": actor.id,
                "role": str(actor.role),
                "model": actor.model,
                "length": float(actor.length),
                "width": float(actor.width),
            }
            for actor in trace.actors
        ],
        "egos": [
            {
                "start_time": float(trace.ego_start_times[ego]),
                "end": str(trace.ego_ends[ego]),
                "end_step": int(trace.ego_end_steps[ego]),
                "privileged": bool(trace.privileged[ego]),
                "route": _route_data(trace.ego_routes[ego]),
                **_reference_data(trace, ego),
            }
            for ego in range(trace.ego_count)
        ],
        "contacts": [[int(c.step), int(c.ego), int(c.other)] for c in trace.contacts],
        "lights": {
            "states": list(trace.light_state_names),
            "changes": {
                light: _changes(trace.light_states[:, index])
                for index, light in enumerate(trace.light_ids)
            },
        },
        "logs": {
            "names": list(trace.log_names),
            "events": [[int(e.step), int(e.ego), e.message] for e in trace.log_events],
        },
        "lane_ids": {str(index): lane_id for index, lane_id in trace.lane_ids.items()},
        "meta": trace.meta,
    }


def trace_from_header(
    header: dict[str, Any],
    *,
    times: NDArray[np.float64],
    states: NDArray[np.float64],
    present: NDArray[np.bool_],
    ego_values: NDArray[np.float64],
    ego_lanes: NDArray[np.int32],
    ego_lights: NDArray[np.uint8],
    log_values: NDArray[np.float64],
    plans: tuple[PlannedPath, ...] = (),
) -> Trace:
    """Returns a trace from the result of ``header_of`` and the arrays of ``Trace``.

    Raises:
        KeyError: An entry of the header is missing.
        TypeError: An entry of the header has another type.
        ValueError: An entry of the header has an unknown value.
        AttributeError: An entry that should be an object is another value.
        OverflowError: A number is too large.
    """
    egos = header["egos"]
    changes = header["lights"]["changes"]
    steps = int(header["steps"])
    light_states = np.zeros((steps, len(changes)), dtype=np.int32)
    for column, pairs in enumerate(changes.values()):
        for step, state in pairs:
            light_states[step:, column] = state
    return Trace(
        network=str(header["network"]),
        network_sha256=str(header["network_sha256"]),
        scenario_sha256=str(header["scenario_sha256"]),
        step_length=float(header["step_length"]),
        times=times,
        actors=tuple(
            Actor(
                row=row,
                id=str(actor["id"]),
                role=Role(actor["role"]),
                model=str(actor["model"]),
                length=float(actor["length"]),
                width=float(actor["width"]),
            )
            for row, actor in enumerate(header["actors"])
        ),
        states=states,
        present=present,
        ego_values=ego_values,
        ego_lanes=ego_lanes,
        ego_lights=ego_lights,
        ego_routes=tuple(_route(ego["route"]) for ego in egos),
        ego_start_times=tuple(float(ego["start_time"]) for ego in egos),
        ego_ends=tuple(TerminalEvent(ego["end"]) for ego in egos),
        ego_end_steps=tuple(int(ego["end_step"]) for ego in egos),
        contacts=tuple(
            Contact(step=int(step), ego=int(ego), other=int(other))
            for step, ego, other in header["contacts"]
        ),
        light_ids=tuple(changes),
        light_states=light_states,
        light_state_names=tuple(header["lights"]["states"]),
        log_names=tuple(header["logs"]["names"]),
        log_values=log_values,
        log_events=tuple(
            LogEvent(step=int(step), ego=int(ego), message=str(message))
            for step, ego, message in header["logs"]["events"]
        ),
        privileged=tuple(bool(ego["privileged"]) for ego in egos),
        max_sim_time=float(header["max_sim_time"]),
        meta=header["meta"],
        plans=plans,
        references=_references(egos),
        lane_ids={int(index): lane_id for index, lane_id in header["lane_ids"].items()},
    )


def _route_data(route: EgoRoute) -> dict[str, Any]:
    return {
        "length": float(route.length),
        "goal": [float(route.goal[0]), float(route.goal[1])],
        "line_f8": _encode(route.line),
        "arc_f8": _encode(route.arc),
    }


def _route(data: dict[str, Any]) -> EgoRoute:
    x, y = data["goal"]
    return EgoRoute(
        line=_decode(data["line_f8"]).reshape(-1, 2),
        arc=_decode(data["arc_f8"]),
        length=float(data["length"]),
        goal=(float(x), float(y)),
    )


def _reference_data(trace: Trace, ego: int) -> dict[str, Any]:
    """Returns the reference path of an ego; nothing if it has none."""
    if not trace.references or not len(trace.references[ego]):
        return {}
    return {"reference_path_f8": _encode(trace.references[ego])}


def _references(egos: list[dict[str, Any]]) -> tuple[NDArray[np.float64], ...]:
    """Returns the reference paths of the egos; nothing if none has one."""
    paths = tuple(
        _decode(ego.get("reference_path_f8", "")).reshape(-1, len(PoseCol)) for ego in egos
    )
    for path in paths:
        if not np.isfinite(path).all() or (np.diff(path[:, PoseCol.TIME]) <= 0.0).any():
            raise ValueError("a reference path whose numbers are not finite, or not in order")
        if len(path) == 1:
            raise ValueError("a reference path of one pose")
    return paths if any(len(path) for path in paths) else ()


def _encode(values: NDArray[np.float64]) -> str:
    """Returns little-endian doubles in base64: exact, and a tenth of the cost of JSON numbers."""
    return base64.b64encode(np.ascontiguousarray(values, dtype="<f8").tobytes()).decode()


def _decode(text: str) -> NDArray[np.float64]:
    return np.frombuffer(base64.b64decode(text, validate=True), dtype="<f8").astype(np.float64)


def _changes(states: NDArray[np.int32]) -> list[list[int]]:
    """Returns ``[step, state]`` at the start and at each step at which the state changes."""
    if not len(states):
        return []
    steps = np.concatenate(([0], np.flatnonzero(np.diff(states)) + 1))
    return [[int(step), int(states[step])] for step in steps]
