from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drivora_service.feedback.objectives import default_objectives, score
from drivora_service.observations.trace import Light, TerminalEvent, Trace
from drivora_service.testing.networks import EAST, straight_road
from drivora_service.testing.oracle_contract import example_runs
from drivora_service.testing.traces import Motion, SyntheticActor, SyntheticEgo, make_trace

ROAD = straight_road()
STEPS = 400


def ego(**fields: Any) -> SyntheticEgo:
    defaults: dict[str, Any] = {
        "motion": Motion.steady(0.0, 0.0, steps=STEPS, speed=5.0),
        "lane": EAST,
        "lane_lateral": 0.0,
        "lane_heading": 0.0,
        "route": np.array([(0.0, 0.0), (100.0, 0.0)]),
    }
    return SyntheticEgo(**{**defaults, **fields})


def scores(*egos: SyntheticEgo, at: tuple[float, float] | None = None) -> dict[str, float | None]:
    others = []
    if at is not None:
        others = [SyntheticActor(motion=Motion.steady(*at, steps=STEPS))]
    return score(make_trace(egos, others), ROAD)


@pytest.mark.parametrize(("side", "expected"), [(3.8, 0.2), (6.8, 0.5), (11.8, 1.0), (50.0, 1.0)])
def test_the_gap_over_ten_metres(side: float, expected: float) -> None:
    assert scores(ego(), at=(50.0, side))["min_gap"] == pytest.approx(expected)


def test_a_collision_course_scores_its_time() -> None:
    slow = ego(motion=Motion.steady(0.0, 0.0, steps=STEPS, speed=1.0))
    found = scores(slow, at=(30.0, 0.0))["time_to_collision"]
    assert found == pytest.approx((30.0 - 4.5 - 399 * 0.05) / 10.0)


def test_no_actor_on_a_collision_course_is_the_safest() -> None:
    assert scores(ego(), at=(50.0, 20.0))["time_to_collision"] == 1.0


@pytest.mark.parametrize("name", ["min_gap", "time_to_collision"])
def test_what_needs_others_is_not_scored_alone(name: str) -> None:
    assert scores(ego())[name] is None


def test_progress_is_the_share_of_the_route() -> None:
    assert scores(ego())["progress"] == pytest.approx(0.9975)
    assert scores(ego(route_s=25.0))["progress"] == 0.25
    assert scores(ego(route_s=np.nan))["progress"] is None


def test_standing_longer_is_nearer_to_a_block() -> None:
    found: list[float] = []
    for rows in (0, 100, 300):
        x = 0.25 * np.maximum(np.arange(STEPS) - rows, 0)
        found.append(scores(ego(motion=Motion.along(x, 0.0)))["stuck_time"] or 0.0)
    assert found[0] == 1.0
    assert found == sorted(found, reverse=True)
    assert found[2] == pytest.approx(1.0 - 15.0 / 60.0, abs=2e-3)


def test_waiting_for_a_signal_is_not_being_stuck() -> None:
    waiting = ego(motion=Motion.steady(0.0, 0.0, steps=STEPS), light=Light.RED, light_distance=2.0)
    assert scores(waiting)["stuck_time"] == 1.0


def test_ending_farther_from_the_goal_is_nearer_to_a_failure() -> None:
    found = []
    for speed in (5.0, 3.0, 0.0):
        motion = Motion.steady(0.0, 0.0, steps=401, speed=speed)
        found.append(scores(ego(motion=motion))["goal_distance"])
    assert found == [pytest.approx(1.0), pytest.approx(0.6), pytest.approx(0.0)]


def test_only_the_egos_part_counts() -> None:
    cut = ego(end=TerminalEvent.COLLISION, end_step=200)
    assert scores(cut)["goal_distance"] == pytest.approx(0.5)
    assert scores(cut)["progress"] == pytest.approx(0.5)


def test_of_several_egos_the_one_nearest_to_a_failure_counts() -> None:
    still = ego(id="still", motion=Motion.steady(0.0, 3.5, steps=STEPS))
    found = scores(ego(id="driving"), still)
    assert found["progress"] == found["progress[still]"] == 0.0
    assert found["progress[driving]"] == pytest.approx(0.9975)


@pytest.mark.parametrize("trace", example_runs())
def test_scores_are_shares_or_none(trace: Trace) -> None:
    found = score(trace, ROAD)
    assert {objective.name for objective in default_objectives()} <= set(found)
    for value in found.values():
        assert value is None or 0.0 <= value <= 1.0
    json.dumps(found, allow_nan=False)


def test_an_ego_that_never_started_has_no_scores() -> None:
    assert set(scores(ego(start_time=100.0)).values()) == {None}


def test_the_reference_names_every_objective(repository: Path) -> None:
    text = (repository / "docs" / "reference" / "oracles.md").read_text(encoding="utf-8")
    section = text.split("## Objectives")[1].split("## ")[0]
    documented = re.findall(r"^\| `(\w+)` \|", section, re.MULTILINE)
    assert documented == [objective.name for objective in default_objectives()]
