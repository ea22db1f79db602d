"""The time line of runs of a real service, compared with their recordings."""

from __future__ import annotations

import io
import json
import math
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pyarrow.parquet as pq
import pytest

from tests.api.conftest import wait_until_final

PARQUET = {"Accept": "application/vnd.apache.parquet"}
CONTAINER = {
    "id": "container",
    "model": "static.prop.container",
    "location": {"x": 3.4, "y": 50.0, "yaw": 91.51},
}


def run_of(http: httpx.Client, document: dict[str, Any]) -> dict[str, Any]:
    posted = http.post("/api/v1/jobs", json=document)
    assert posted.status_code == 202, posted.text
    job = wait_until_final(http, posted.json()["id"])
    assert job["status"] == "finished", job
    run: dict[str, Any] = http.get(job["run_url"]).json()
    return run


@pytest.fixture
def lit_run(http: httpx.Client, repository: Path) -> dict[str, Any]:
    """A run through several signals among background traffic."""
    example = repository / "openscenario_schemas" / "examples" / "signalised-grid.json"
    return run_of(http, json.loads(example.read_text()))


def recording(http: httpx.Client, run: dict[str, Any]) -> Any:
    content = http.get(run["observations_url"], headers=PARQUET).content
    return pq.read_table(io.BytesIO(content)).to_pandas()


def test_a_collision_has_its_moments(http: httpx.Client, scenario: dict[str, Any]) -> None:
    scenario["npc_obstacles"] = [CONTAINER]
    scenario["ego_vehicles"][0]["agent"] = {"name": "scripted"}
    run = run_of(http, scenario)
    timeline = http.get(f"/api/v1/runs/{run['id']}/timeline").json()
    (collision,) = (mark for mark in timeline["violations"] if mark["oracle"] == "collision")
    (verdict,) = (v for v in run["verdicts"] if v["oracle"] == "collision")
    assert (collision["first"], collision["last"]) == (verdict["step"], verdict["step"])
    assert collision["message"] == verdict["message"]
    assert collision["counterpart"] == "container"
    assert collision["accountability"] == run["accountability"] == "avoidable"
    before = verdict["evidence"]["avoidability"]["latest_before"]
    until = verdict["step"] - collision["avoidable_until"]
    assert until * timeline["step_length"] == pytest.approx(before)
    assert 0 <= collision["risk_perceived"] <= collision["avoidable_until"] < collision["first"]
    numbers = [mark["number"] for mark in timeline["violations"]]
    assert numbers == list(range(1, len(numbers) + 1))
    (ego,) = timeline["egos"]
    assert (ego["agent"], ego["end"], ego["last"]) == ("scripted", "collision", verdict["step"])


def test_a_violation_that_lasts_has_its_last_step(
    http: httpx.Client, scenario: dict[str, Any]
) -> None:
    ego = scenario["ego_vehicles"][0]
    ego["agent"] = {"name": "idm", "parameters": {"speed_factor": 1.5}}
    ego["initial_speed"] = 10.0
    run = run_of(http, scenario)
    timeline = http.get(f"/api/v1/runs/{run['id']}/timeline").json()
    speeding = [mark for mark in timeline["violations"] if mark["oracle"] == "speeding"]
    assert speeding
    table = recording(http, run)
    over = np.hypot(table["vx"], table["vy"]) > 1.05 * table["ego_speed_limit"]
    rows = set(np.flatnonzero(over & (table["actor"] == 0)).tolist())
    for mark in speeding:
        assert set(range(mark["first"], mark["last"] + 1)) <= rows
        assert mark["first"] - 1 not in rows
        assert mark["last"] + 1 not in rows


def test_signals_are_those_whose_stop_lines_the_ego_drove_over(
    http: httpx.Client, lit_run: dict[str, Any]
) -> None:
    timeline = http.get(f"/api/v1/runs/{lit_run['id']}/timeline").json()
    geometry = http.get("/api/v1/networks/signal-grid/geometry").json()
    lines = {line["lane"]: line for line in geometry["stop_lines"]}
    table = recording(http, lit_run)
    ego = table[table["actor"] == 0].set_index("step")
    colours = ["none", "green", "yellow", "red"]
    approaches = [(light, one) for light in timeline["lights"] for one in light["approaches"]]
    passed = [one for _, one in approaches if one["passed"] is not None]
    assert len(passed) >= 2
    for light, approach in approaches:
        line = lines[light["lane"]]
        assert line["light"] == light["id"]
        assert light["link"] in {movement["link"] for movement in line["movements"]}
        shown = {
            step: phase["light"]
            for phase in light["phases"]
            for step in range(phase["first"], phase["last"] + 1)
        }
        assert sorted(shown) == list(range(timeline["steps"]))
        rows = ego.loc[approach["first"] : approach["last"]]
        assert [shown[step] for step in rows.index] == [colours[int(n)] for n in rows["light"]]
        if approach["passed"] is None:
            continue
        # The front bumper is at the line as it passes: by places, not by the route's distances.
        at = ego.loc[approach["passed"]]
        half = 0.5 * timeline["actors"][0]["length"]
        front = at["x"] + half * math.cos(at["yaw"]), at["y"] + half * math.sin(at["yaw"])
        middle = np.mean(line["points"], axis=0)
        assert math.dist(front, middle) < 2.0


def test_actors_come_and_go(http: httpx.Client, lit_run: dict[str, Any]) -> None:
    timeline = http.get(f"/api/v1/runs/{lit_run['id']}/timeline").json()
    table = recording(http, lit_run)
    assert timeline["steps"] == lit_run["steps"]
    assert timeline["duration"] == pytest.approx(lit_run["sim_time_s"])
    for actor in timeline["actors"][1:]:
        steps = [s for span in actor["present"] for s in range(span["first"], span["last"] + 1)]
        assert steps == table[table["actor"] == actor["row"]]["step"].tolist()
    (ego,) = timeline["egos"]
    assert ego["first"] * timeline["step_length"] == pytest.approx(1.0)


def test_what_is_known_is_not_computed_again(
    http: httpx.Client, finished_run: dict[str, Any]
) -> None:
    url = f"/api/v1/runs/{finished_run['id']}/timeline"
    answer = http.get(url)
    known = {"If-None-Match": answer.headers["ETag"]}
    assert http.get(url, headers=known).status_code == 304
    assert http.get("/api/v1/runs/none/timeline").status_code == 404
