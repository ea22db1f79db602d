from __future__ import annotations

import json
import math

import pytest

from drivora_service.observations.scene_obs import ndjson, scene_frames
from drivora_service.observations.trace import Trace


def test_a_frame_has_the_published_shape(full_trace: Trace) -> None:
    (frame,) = scene_frames(full_trace, 35, 36)
    assert list(frame) == ["step", "timestamp", "egos", "other_actors", "agent_logs"]
    assert frame["step"] == 35
    assert frame["timestamp"] == pytest.approx(1.75)
    assert [ego["id"] for ego in frame["egos"]] == ["one", "two"]
    assert {name: len(group) for name, group in frame["other_actors"].items()} == {
        "vehicles": 1,
        "walkers": 1,
        "obstacles": 1,
        "background": 1,
        "traffic_lights": 1,
    }
    assert frame["other_actors"]["traffic_lights"] == [{"id": "junction", "state": "rG"}]
    walker = frame["other_actors"]["walkers"][0]
    assert walker["kind"] == "walker"
    assert walker["position"] == {"x": pytest.approx(31.75), "y": 4.0, "z": 0.0}
    assert walker["size"] == {"length": 4.5, "width": 1.8}


def test_angles_are_degrees(full_trace: Trace) -> None:
    (frame,) = scene_frames(full_trace, 20, 21)
    ego = frame["egos"][0]
    assert ego["yaw"] == pytest.approx(math.degrees(full_trace.states[20, 0, 2]), abs=1e-5)
    assert ego["yaw_rate"] == pytest.approx(math.degrees(full_trace.states[20, 0, 7]), abs=1e-5)
    steer = math.degrees(full_trace.ego_values[20, 0, 1])
    assert ego["control"]["steer"] == pytest.approx(steer, abs=1e-5)
    assert ego["lane"]["heading"] == pytest.approx(math.degrees(0.1), abs=1e-5)


def test_what_does_not_apply_is_null(full_trace: Trace) -> None:
    on, off = (next(iter(scene_frames(full_trace, k, k + 1)))["egos"][0] for k in (20, 50))
    assert on["lane"]["id"] == "north_0"
    assert on["light"] == {"state": "red", "distance": pytest.approx(12.0)}
    assert off["lane"] is None
    assert off["light"] is None


def test_others_are_listed_while_they_are_present(full_trace: Trace) -> None:
    walkers = [len(f["other_actors"]["walkers"]) for f in scene_frames(full_trace, 0, 80)]
    assert walkers == [0] * 10 + [1] * 60 + [0] * 10


def test_agents_logs_stand_with_the_step_at_which_they_were_written(full_trace: Trace) -> None:
    frames = list(scene_frames(full_trace, 4, 6))
    assert frames[0]["agent_logs"]["two"]["values"] == {"gap": 1.0, "target_speed": None}
    assert frames[0]["agent_logs"]["two"]["events"] == ["Vorfahrt gewähren — “yield”"]
    assert frames[0]["agent_logs"]["one"] == {
        "values": {"gap": None, "target_speed": 8.0},
        "events": [],
    }
    assert frames[1]["agent_logs"]["two"]["events"] == []


def test_ndjson_is_a_strict_json_line_a_frame(full_trace: Trace) -> None:
    def refuse(word: str) -> float:
        raise AssertionError(f"{word} is no JSON")

    lines = list(ndjson(full_trace, 0, 80))
    assert all(line.endswith(b"\n") and line.count(b"\n") == 1 for line in lines)
    parsed = [json.loads(line, parse_constant=refuse) for line in lines]
    assert parsed == list(scene_frames(full_trace, 0, 80))


@pytest.mark.parametrize(
    ("first", "last", "expected"),
    [(-5, 2, [0, 1]), (78, 500, [78, 79]), (40, 40, []), (300, 400, [])],
)
def test_a_range_is_cut_to_what_is_there(
    full_trace: Trace, first: int, last: int, expected: list[int]
) -> None:
    assert [frame["step"] for frame in scene_frames(full_trace, first, last)] == expected


def test_ranges_add_up_to_the_whole(full_trace: Trace) -> None:
    pieces = [line for k in range(0, 80, 7) for line in ndjson(full_trace, k, min(k + 7, 80))]
    assert pieces == list(ndjson(full_trace, 0, 80))
