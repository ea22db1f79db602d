"""Three fixed runs, exactly as they were when last approved, on every machine.

The hash of a trace tells that something has changed, in whatever bit; where the egos are, second by
second, tells what. After a change that is meant to move the egos::

    python -m tests.simulation.test_golden --regenerate
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pytest

from drivora_service.observations.trace import Col, Trace
from drivora_service.observations.trace_files.trace_hash import trace_sha256
from drivora_service.scenario.model import Scenario, VehicleDynamics, Weather
from tests.simulation.episodes import car, ego, place, run, scenario, walker

FOLDER = Path(__file__).with_name("golden")
HASHES = FOLDER / "hashes.json"


def scenarios() -> dict[str, Scenario]:
    """The runs, by name."""
    grid = "signal-grid"
    return {
        "tee-town-right-turn-behind-a-slow-car": scenario(
            ego(place("harbour_0_0", 60), place("ferry_1_0", 60)),
            npc_vehicles=(
                car(place("harbour_0_0", 100, speed=5.0), place("harbour_1_0", 110, speed=5.0)),
            ),
            npc_walkers=(
                walker(place("harbour_1_0", 60, right=5.0), place("harbour_1_0", 60, right=-5.0)),
            ),
            weather=Weather(wetness=60.0),
            seconds=60.0,
        ),
        "signal-grid-two-egos-at-signals": scenario(
            ego(place("grand_1_1", 30, on=grid), place("bridge_2_1", 60, on=grid), name="turns"),
            ego(place("castle_1_1", 20, on=grid), place("castle_3_1", 50, on=grid), name="crosses"),
            on=grid,
            seconds=70.0,
        ),
        "highway-exit-in-a-dynamic-body": scenario(
            ego(
                place("eb_1_1", 20, on="highway"),
                place("eb_a_decelerate_0", 220, on="highway"),
                initial_speed=22.0,
                dynamics=VehicleDynamics.DYNAMIC,
            ),
            on="highway",
            seconds=40.0,
        ),
    }


def seconds_of(trace: Trace) -> dict[str, list[list[float]]]:
    """[x, y, speed] of each ego at every full second of its part, by ego id."""
    stride = round(1.0 / trace.step_length)
    found = {}
    for row, actor in enumerate(trace.actors[: trace.ego_count]):
        part = trace.states[: trace.ego_end_steps[row] + 1 : stride, row]
        speed = np.hypot(part[:, Col.VX], part[:, Col.VY])
        found[actor.id] = np.column_stack((part[:, :2], speed)).round(4).tolist()
    return found


@pytest.mark.parametrize("name", scenarios())
def test_the_egos_drive_as_approved(name: str) -> None:
    approved = json.loads((FOLDER / f"{name}.json").read_text())
    trace = run(scenarios()[name])
    found = seconds_of(trace)
    assert found.keys() == approved.keys()
    for ego_id, rows in found.items():
        assert len(rows) == len(approved[ego_id])
        late = [n for n, row in enumerate(rows) if row != approved[ego_id][n]]
        assert not late, f"{ego_id} differs first at {late[0]} s"
    assert trace_sha256(trace) == json.loads(HASHES.read_text())[name]


def regenerate() -> None:
    """Writes what the runs give now as approved."""
    FOLDER.mkdir(exist_ok=True)
    hashes = {}
    for name, what in scenarios().items():
        trace = run(what)
        hashes[name] = trace_sha256(trace)
        lines = ",\n".join(
            f' "{ego_id}": [\n  ' + ",\n  ".join(json.dumps(row) for row in rows) + "\n ]"
            for ego_id, rows in seconds_of(trace).items()
        )
        (FOLDER / f"{name}.json").write_text("{\n" + lines + "\n}\n")
    HASHES.write_text(json.dumps(hashes, indent=1) + "\n")


if __name__ == "__main__":
    if sys.argv[1:] != ["--regenerate"]:
        sys.exit("python -m tests.simulation.test_golden --regenerate")
    regenerate()
