"""A hash over all physical data of a trace: equal hashes mean the same run, bit for bit."""

from __future__ import annotations

import hashlib
import json
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivora_service.observations.trace import Trace

_VERSION = "trace-hash-1"


def trace_sha256(trace: Trace) -> str:
    """Returns the SHA-256 of a trace, hexadecimal.

    Covered: times, actors, states, presence, ego values, lanes, lights, routes, ends, contacts,
    traffic lights, agent logs, the network's and the scenario's hash. Not covered: ``meta``,
    ``lane_ids`` and ``plans``, none of which has an effect on the run, and ``references``, which
    are the scenario's.

    Two traces with the same numbers have the same hash for any memory layout of their
    arrays, the bits of their NaNs, the sign of their zeros, or values in the rows of actors
    that are not present.
    """
    digest = hashlib.sha256(_header(trace))
    present = np.ascontiguousarray(trace.present, dtype=np.bool_)
    states = _canonical_floats(trace.states)
    states[~present] = np.nan
    _feed(digest, states)
    _feed(digest, present)
    for floats in (trace.times, trace.ego_values, trace.log_values):
        _feed(digest, _canonical_floats(floats))
    _feed(digest, np.ascontiguousarray(trace.ego_lanes, dtype="<i4"))
    _feed(digest, np.ascontiguousarray(trace.ego_lights, dtype=np.uint8))
    _feed(digest, np.ascontiguousarray(trace.light_states, dtype="<i4"))
    for route in trace.ego_routes:
        _feed(digest, _canonical_floats(route.line))
        _feed(digest, _canonical_floats(route.arc))
    return digest.hexdigest()


def egos_sha256(trace: Trace) -> str:
    """Returns the SHA-256 of the motion of the egos and the ends of their parts, hexadecimal.

    Two runs have the same if every ego did the same in every step of its part, whatever the other
    actors did, and however the scenarios differ in them. What agents logged is not covered.
    """
    facts = [
        float(trace.step_length),
        [
            [str(end), int(step), float(start), trace.actors[row].id, trace.actors[row].model]
            for row, (end, step, start) in enumerate(
                zip(trace.ego_ends, trace.ego_end_steps, trace.ego_start_times, strict=True)
            )
        ],
    ]
    digest = hashlib.sha256(json.dumps(facts, separators=(",", ":")).encode())
    for row, end in enumerate(trace.ego_end_steps):
        _feed(digest, _canonical_floats(trace.states[: end + 1, row]))
    return digest.hexdigest()


def _header(trace: Trace) -> bytes:
    """Returns the data that is not in arrays, in one canonical form."""
    facts = [
        _VERSION,
        trace.network,
        trace.network_sha256,
        trace.scenario_sha256,
        float(trace.step_length),
        float(trace.max_sim_time),
        [
            [a.row, a.id, str(a.role), a.model, float(a.length), float(a.width)]
            for a in trace.actors
        ],
        [[float(r.length), float(r.goal[0]), float(r.goal[1])] for r in trace.ego_routes],
        [float(time) for time in trace.ego_start_times],
        [str(end) for end in trace.ego_ends],
        [int(step) for step in trace.ego_end_steps],
        [[int(c.step), int(c.ego), int(c.other)] for c in trace.contacts],
        list(trace.light_ids),
        list(trace.light_state_names),
        list(trace.log_names),
        [[int(e.step), int(e.ego), e.message] for e in trace.log_events],
        [bool(flag) for flag in trace.privileged],
    ]
    return json.dumps(facts, separators=(",", ":")).encode()


def _canonical_floats(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns a contiguous little-endian copy with one bit pattern for NaN and one for zero."""
    copy = np.add(values, 0.0, order="C", dtype="<f8")
    copy[np.isnan(copy)] = np.nan
    return copy


def _feed(digest: hashlib._Hash, array: NDArray[Any]) -> None:
    """Adds an array's shape and its bytes, so that equal bytes of another shape differ."""
    digest.update(repr(array.shape).encode())
    digest.update(array.data if array.size else b"")
