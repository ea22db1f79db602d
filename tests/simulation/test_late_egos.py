"""Egos whose part begins after the start of the run: their first frame is complete."""

from __future__ import annotations

import numpy as np
import pytest

from drivora_service.agents.interface import AccelerationControl, Observation
from drivora_service.observations.trace import Col, EgoCol, Light
from tests.simulation.episodes import ROAD, Scripted, ego, place, run, scenario

START = 2.0
SIGNAL_ROAD = "signal-grid"


@pytest.mark.parametrize("agent", ["idm", "sumo-krauss"])
@pytest.mark.parametrize("start", [0.0, START])
def test_the_first_recorded_step_of_an_ego_has_its_route_and_its_light(
    start: float, agent: str
) -> None:
    late = ego(
        place("grand_1_1", 30, on=SIGNAL_ROAD), place("grand_3_1", 60, on=SIGNAL_ROAD),
        agent=agent, start_time=start, initial_speed=6.0,
    )  # fmt: skip
    trace = run(scenario(late, on=SIGNAL_ROAD, seconds=6.0))
    first = round(start / trace.step_length)
    values = trace.ego_values[:, 0]
    assert np.isnan(values[:first, EgoCol.ROUTE_S]).all()
    assert np.isfinite(values[first:, EgoCol.ROUTE_S]).all()
    assert np.isfinite(values[first:, EgoCol.LIGHT_DISTANCE]).all()
    assert (trace.ego_lights[first:, 0] != Light.NONE).all()
    assert values[first, EgoCol.ROUTE_S] == pytest.approx(0.0, abs=0.01)
    assert values[first + 1, EgoCol.ROUTE_S] > 0.2


def test_a_late_ego_begins_with_its_speed_and_without_a_jolt() -> None:
    seen: list[Observation] = []

    def note(observation: Observation) -> AccelerationControl:
        if not seen:
            assert np.isfinite([observation.route_s, observation.route_lateral]).all()
            assert observation.ego[Col.VX] ** 2 + observation.ego[Col.VY] ** 2 == pytest.approx(81)
            assert observation.speed == 9.0
        seen.append(observation)
        return AccelerationControl(0.0, 0.0)

    late = ego(place(ROAD, 10), place(ROAD, 120), start_time=START, initial_speed=9.0)
    trace = run(scenario(late, seconds=4.0), Scripted(note))
    first = round(START / trace.step_length)
    velocity = np.hypot(*trace.states[:, 0, [Col.VX, Col.VY]].T)
    assert np.all(velocity[:first] == 0.0)
    assert velocity[first] == pytest.approx(9.0)
    assert np.abs(trace.states[:, 0, [Col.AX, Col.AY]]).max() < 0.5
    moved = np.hypot(*np.diff(trace.states[:, 0, [Col.X, Col.Y]], axis=0).T)
    assert np.all(moved[:first] == 0.0)
    assert moved[first] == pytest.approx(9.0 * trace.step_length, rel=0.01)
    assert len(seen) == trace.step_count - 1 - first
