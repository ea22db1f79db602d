"""Later starts: actors begin where a recording has them, as the trace itself tells."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.observations.trace import Col
from drivora_service.observations.trace_files.trace_file import read_trace
from drivora_service.runs.run_report import RunSpec
from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.documents import ScenarioDocument
from drivora_service.scenario.entities import NpcVehicleDocument, NpcWalkerDocument
from drivora_service.scenario.exporting import to_document
from drivora_service.scenario.validation import validate_data, validate_document
from drivora_service.suites.minimization.edits import apply_edits
from drivora_service.suites.minimization.later_starts import (
    BEFORE_S,
    later_starts,
    recording_of,
)
from drivora_service.worker.performing import perform
from drivora_service.worker.setup import WorkerSetup

EXAMPLES = Path(__file__).parents[3] / "openscenario_schemas" / "examples"
NETWORKS = NetworkCatalogue(shipped_networks())


def read(name: str) -> ScenarioDocument:
    path = EXAMPLES / name
    return to_document(validate_data(path.read_bytes(), NETWORKS, None).scenario)


def others(document: ScenarioDocument) -> list[NpcVehicleDocument | NpcWalkerDocument]:
    return [*document.npc_vehicles, *document.npc_walkers]


@pytest.mark.slow(seconds=20)
@pytest.mark.parametrize("name", ["lead-vehicle-and-pedestrian.json", "highway-cut-in.json"])
def test_actors_begin_where_they_were(name: str, tmp_path: Path) -> None:
    document = read(name)
    valid = validate_document(document, NETWORKS, None)
    path = tmp_path / "run.parquet"
    setup = WorkerSetup(shipped_networks=shipped_networks(), imported_networks=None)
    perform(
        RunSpec(run_id="run", document=canonical_json(valid.scenario), trace_path=str(path)), setup
    )
    trace = read_trace(path)
    (choices,) = later_starts(document, recording_of(trace), failed_at=12.0)
    assert [choice.label for choice in choices if "lights" not in choice.label] == [
        f"begins {12.0 - seconds:g} s later" for seconds in BEFORE_S if seconds <= 11.0
    ]
    for seconds, choice in zip(BEFORE_S, choices[:: len(choices) // 3], strict=False):
        begin = 12.0 - seconds
        later = apply_edits(document, [choice])
        assert later is not None
        row = int(np.argmin(np.abs(trace.times - begin)))
        rows = {actor.id: actor.row for actor in trace.actors}
        seen = 0
        for ego in later.ego_vehicles:
            x, y, yaw, vx, vy = trace.states[row, rows[ego.id]][
                [Col.X, Col.Y, Col.YAW, Col.VX, Col.VY]
            ].tolist()
            assert (ego.route[0].x, ego.route[0].y) == pytest.approx((x, y), abs=0.006)
            assert ego.initial_speed == pytest.approx(math.hypot(vx, vy), abs=0.006)
            assert ego.route[0].yaw is not None
            turn = math.remainder(math.radians(ego.route[0].yaw) - yaw, math.tau)
            assert turn == pytest.approx(0.0, abs=0.001)
            (whole,) = (one.route for one in document.ego_vehicles if one.id == ego.id)
            assert ego.route[1:] == whole[len(whole) - len(ego.route) + 1 :]
            assert ego.start_time == 0.0
        for npc in others(later):
            (before,) = (actor for actor in others(document) if actor.id == npc.id)
            at = rows[npc.id]
            if before.start_time >= begin:
                assert npc.start_time == pytest.approx(before.start_time - begin)
                assert npc.route == before.route
                continue
            seen += 1
            assert trace.present[row, at]
            place = trace.states[row, at][[Col.X, Col.Y]].tolist()
            assert (npc.route[0].x, npc.route[0].y) == pytest.approx(place, abs=0.006)
            assert len(npc.route) <= len(before.route)
            assert npc.route[1:] == before.route[len(before.route) - len(npc.route) + 1 :]
        assert seen
        gone = {actor.id for actor in document.npc_vehicles} - {a.id for a in later.npc_vehicles}
        assert not any(trace.present[row, rows[actor]] for actor in gone if actor in rows)
