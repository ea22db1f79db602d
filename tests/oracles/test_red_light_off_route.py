"""Every stop line that an ego drives over counts, on its route or off it."""

from __future__ import annotations

import numpy as np
import pytest

from drivora_service.observations.trace import Light
from drivora_service.oracles.blocked import Blocked
from drivora_service.oracles.red_light import RedLight
from drivora_service.oracles.verdict import Outcome, Verdict
from drivora_service.testing.traces import Motion
from tests.oracles.streets import DT, along, judge_on, on_network, steady, way
from tests.simulation.episodes import network

GRID = network("signal-grid")
BEFORE, STRAIGHT, LEFT = "-bridge_3_2", "-bridge_2_2", "queen_3_1"
STOP_LINE = float(GRID.lane(BEFORE).arc[-1])
"""Metres along the way at which the lane ends."""
AHEAD, TO_THE_LEFT = 2, 3
"""Places of the two movements in the state of the signal ``c3``."""
STEPS = 400
FRONT = steady(10.0, STEPS)


def shown(letters: dict[int, str], steps: int = STEPS) -> dict[str, list[str]]:
    """What the signal shows: red but for some movements."""
    count = len(GRID.programs["c3"].phases[0].state)
    return {"c3": ["".join(letters.get(link, "r") for link in range(count))] * steps}


def run_signal(
    letters: dict[int, str], *, to: str = STRAIGHT, lateral: float = 100.0
) -> tuple[Verdict, ...]:
    """Drives over the stop line, far from a route of which nothing is known but how far."""
    line = way(GRID, BEFORE, to)
    ego = on_network(GRID, along(line, FRONT), route_lateral=lateral)
    return judge_on(GRID, RedLight(), ego, lights=shown(letters))


@pytest.mark.parametrize("lateral", [0.0, 100.0])
def test_a_red_signal_off_the_route_is_run(lateral: float) -> None:
    (verdict,) = run_signal({TO_THE_LEFT: "G"}, lateral=lateral)
    assert verdict.outcome is Outcome.VIOLATED
    assert verdict.step is not None
    tail = FRONT[verdict.step] - 4.5
    assert STOP_LINE <= tail <= STOP_LINE + 10.0 * DT + 0.1
    assert verdict.evidence["front_crossed_on"] == "red"
    assert verdict.evidence["speed"] == pytest.approx(10.0, abs=0.1)


def test_the_signal_is_that_of_the_movement_which_was_driven() -> None:
    (ahead,) = run_signal({AHEAD: "G"})
    assert ahead.outcome is Outcome.PASSED
    assert ahead.evidence["lines"] == 1
    assert [v.outcome for v in run_signal({AHEAD: "G"}, to=LEFT)] == [Outcome.VIOLATED]
    assert [v.outcome for v in run_signal({TO_THE_LEFT: "g"}, to=LEFT)] == [Outcome.PASSED]


def test_four_reds_elsewhere_are_four_violations() -> None:
    line = way(GRID, BEFORE, STRAIGHT)
    motion = along(line, np.concatenate([FRONT[:250]] * 4))
    count = len(GRID.programs["c3"].phases[0].state)
    ego = on_network(GRID, motion, route_lateral=20.0)
    verdicts = judge_on(GRID, RedLight(), ego, lights={"c3": ["r" * count] * 1000})
    assert [verdict.outcome for verdict in verdicts] == [Outcome.VIOLATED] * 4


def test_another_streets_red_is_not_charged_to_who_passes_beside_the_route() -> None:
    front = np.linspace(0.0, 100.0, STEPS)
    line = np.array([(-500.0, -500.0), (-400.0, -500.0)])
    distance = np.where(front - 4.5 <= 50.0, 50.0 - front, np.nan)
    fields = {"light": Light.RED, "light_distance": distance, "route_s": front - 2.25}
    near, far = (
        judge_on(
            GRID, RedLight(), on_network(GRID, along(line, front), route_lateral=lateral, **fields)
        )
        for lateral in (4.0, 25.0)
    )
    assert [verdict.outcome for verdict in near] == [Outcome.VIOLATED]
    assert [verdict.outcome for verdict in far] == [Outcome.NOT_APPLICABLE]


def test_past_the_red_on_the_other_side_of_the_road_is_past_it() -> None:
    line = way(GRID, BEFORE, STRAIGHT)
    on_lane = along(line, FRONT)
    yaw = on_lane.states[:, 2]
    left = Motion.along(
        on_lane.states[:, 0] - 4.0 * np.sin(yaw), on_lane.states[:, 1] + 4.0 * np.cos(yaw), yaw=yaw
    )
    distance = np.where(FRONT - 4.5 <= STOP_LINE, STOP_LINE - FRONT, np.nan)
    ego = on_network(
        GRID,
        left,
        route_lateral=4.0,
        route_s=FRONT - 2.25,
        light=np.where(np.isnan(distance), Light.NONE, Light.RED),
        light_distance=distance,
    )
    verdicts = judge_on(GRID, RedLight(), ego, lights=shown({}))
    assert [verdict.outcome for verdict in verdicts] == [Outcome.VIOLATED]


def test_an_ego_that_follows_its_route_is_charged_once() -> None:
    line = way(GRID, BEFORE, STRAIGHT)
    distance = np.where(FRONT - 4.5 <= STOP_LINE, STOP_LINE - FRONT, np.nan)
    ego = on_network(
        GRID,
        along(line, FRONT),
        route_s=FRONT - 2.25,
        light=np.where(np.isnan(distance), Light.NONE, Light.RED),
        light_distance=distance,
    )
    (verdict,) = judge_on(GRID, RedLight(), ego, lights=shown({TO_THE_LEFT: "G"}))
    assert verdict.outcome is Outcome.VIOLATED


def test_an_ego_that_leaves_no_way_its_lane_knows_cannot_be_judged() -> None:
    line = way(GRID, BEFORE, STRAIGHT)
    steps = int(np.argmax(FRONT - 4.5 > STOP_LINE)) + 1
    ego = on_network(GRID, along(line, FRONT[:steps]), lane=-1)
    (verdict,) = judge_on(GRID, RedLight(), ego, lights=shown({AHEAD: "G"}, steps))
    assert verdict.outcome is Outcome.NOT_MEASURABLE
    assert verdict.evidence["unclear"] == 1


@pytest.mark.parametrize(("letter", "outcome"), [("r", Outcome.PASSED), ("G", Outcome.VIOLATED)])
def test_waiting_at_a_red_off_the_route_is_no_block(letter: str, outcome: Outcome) -> None:
    line = way(GRID, BEFORE, STRAIGHT)
    steps = 1500
    front = np.minimum(steady(10.0, steps), STOP_LINE - 1.0)
    ego = on_network(GRID, along(line, front), route_lateral=25.0)
    lights = shown({AHEAD: letter, TO_THE_LEFT: letter}, steps)
    assert [v.outcome for v in judge_on(GRID, Blocked(), ego, lights=lights)] == [outcome]
