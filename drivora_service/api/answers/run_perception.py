"""The perception of an ego as JSON or Arrow."""

from __future__ import annotations

import math

import numpy as np

from drivora_service.api.schemas.perception import Perception, PerceptionHead, Sensor
from drivora_service.errors import Conflict
from drivora_service.observations.run_view import EgoView
from drivora_service.observations.trace import Col
from drivora_service.observations.trace_files.table_stream import TableStream, one_batch
from drivora_service.scenario.model import Scenario
from drivora_service.simulation.perception.ego_perception import Sense, Sight
from drivora_service.simulation.perception.perceived_again import Perceived, perceive_again
from drivora_service.store.runs.run_records import RunRecord

_METADATA = "drivora_perception"
_NAMES = tuple(sight.name.lower() for sight in Sight)
_STATES = (Col.X, Col.Y, Col.YAW, Col.VX, Col.VY)


def perception_json(
    record: RunRecord, scenario: Scenario, ego: EgoView, *, is_sumo_driver: bool
) -> bytes:
    """Returns how many actors an ego perceived, by step.

    Raises:
        Conflict: SUMO drives it, or its perception cannot be computed again.
    """
    found = _perceive(scenario, ego, is_sumo_driver)
    there = _there(ego, found)
    counts = {
        name: tuple(((found.sights == sight) & there).sum(axis=1).tolist())
        for sight, name in enumerate(_NAMES)
    }
    perception = Perception(
        **_head(record, ego, found).model_dump(),
        first=found.first,
        present=tuple(there.sum(axis=1).tolist()),
        counts=counts,
    )
    return perception.model_dump_json().encode()


def perception_table(
    record: RunRecord, scenario: Scenario, ego: EgoView, *, is_sumo_driver: bool
) -> TableStream:
    """Returns a row for each step and other actor that is there or perceived.

    Raises:
        Conflict: SUMO drives it, or its perception cannot be computed again.
    """
    found = _perceive(scenario, ego, is_sumo_driver)
    step, actor = np.nonzero(_there(ego, found) | (found.sights == Sight.PERCEIVED))
    columns = {
        "step": (found.first + step).astype(np.int32),
        "actor": actor.astype(np.int16),
        "sight": found.sights[step, actor],
        **{col.name.lower(): found.states[step, actor, col] for col in _STATES},
    }
    return one_batch(columns, {_METADATA: _head(record, ego, found).model_dump_json()})


def _there(ego: EgoView, found: Perceived) -> np.ndarray[tuple[int, int], np.dtype[np.bool_]]:
    """Returns the (n, N) flags of other actors in the world."""
    there = ego.trace.present[found.first : found.first + len(found.sights)].copy()
    there[:, ego.row] = False
    return there


def _perceive(scenario: Scenario, ego: EgoView, is_sumo_driver: bool) -> Perceived:
    if is_sumo_driver:
        raise Conflict(f"SUMO drives the ego {ego.id!r}: it has no perception")
    return perceive_again(scenario, ego)


def _head(record: RunRecord, ego: EgoView, found: Perceived) -> PerceptionHead:
    reach = float(found.senses[Sense.RANGE])
    return PerceptionHead(
        run_id=record.id,
        ego=ego.id,
        row=ego.row,
        privileged=ego.trace.privileged[ego.row],
        sensor=Sensor(
            range=reach if math.isfinite(reach) else None,
            position_noise=float(found.senses[Sense.POSITION_NOISE]),
            speed_noise=float(found.senses[Sense.SPEED_NOISE]),
            dropout=float(found.senses[Sense.DROPOUT]),
            latency_steps=int(found.senses[Sense.LAG]),
            hides=bool(found.senses[Sense.HIDES]),
        ),
        sights=_NAMES,
    )
