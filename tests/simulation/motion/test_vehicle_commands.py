"""What agents answer, as vehicles follow it."""

from __future__ import annotations

import numpy as np
import pytest

from drivora_service.agents.interface import Control, Observation, TrajectoryControl
from drivora_service.observations.trace import Col
from tests.simulation.episodes import Scripted, ego, network, place, run, scenario, speeds

WEST = "-harbour_1_0"


def stop_here(observation: Observation) -> Control:
    x, y = observation.ego[[Col.X, Col.Y]].tolist()
    return TrajectoryControl(np.array([(0.1, x, y, 0.0), (0.2, x, y, 0.0), (1.0, x, y, 0.0)]))


def test_a_trajectory_that_goes_nowhere_keeps_the_heading() -> None:
    heading = network().lane(WEST).position_at(20.0)[2]
    assert abs(heading) > 2.0
    way = place(WEST, 20.0), place(WEST, 100.0)
    trace = run(scenario(ego(*way, initial_speed=8.0), seconds=4.0), Scripted(stop_here))
    assert speeds(trace, "ego")[0] > 7.0
    assert speeds(trace, "ego")[-1] == 0.0
    assert trace.states[:, 0, Col.YAW] == pytest.approx(heading, abs=0.01)
