from __future__ import annotations

import numpy as np
import pytest

from drivora_service.observations.run_view import EgoView, RunView
from drivora_service.observations.trace import Light
from drivora_service.oracles.avoidability.breach import Breach, OwnBreach, find_own_breach
from drivora_service.testing.networks import CROSSING, EAST
from drivora_service.testing.traces import SyntheticActor, SyntheticEgo, make_trace
from tests.oracles.avoidability.collisions import ROAD, STEP, moving, steady
from tests.oracles.judging import on_lane

STEPS = 200
TIME = STEP * np.arange(STEPS)
AWAY = steady(-500.0, 0.0, steps=STEPS)
"""Another actor that has nothing to do with the ego."""


def ego_view(ego: SyntheticEgo) -> EgoView:
    return RunView(make_trace([ego], [SyntheticActor(motion=AWAY, id="other")]), ROAD).egos[0]


def own_breach(ego: EgoView, k: int) -> OwnBreach | None:
    return find_own_breach(ego, k, 1, k, in_time_at_limit=lambda: False)


def test_an_ego_on_its_road_breaks_nothing() -> None:
    ego = ego_view(on_lane(motion=steady(0.0, 0.0, 10.0, steps=STEPS)))
    assert own_breach(ego, 100) is None


def test_an_ego_that_reaches_over_into_the_oncoming_lane() -> None:
    """It drifts left at 1 m/s from 2 s on; its road ends at y = 5.25 m, its side is at y + 0.9."""
    lateral = np.clip(TIME - 2.0, 0.0, None)
    ego = ego_view(
        on_lane(
            motion=moving(10.0 * TIME, lateral, yaw=0.0), lane_lateral=lateral, lane_heading=0.0
        )
    )
    found = own_breach(ego, STEPS - 1)
    assert found is not None
    assert found.kind is Breach.OFF_ITS_SIDE
    # 5.25 m and 0.3 m more, less 0.9 m: after 4.65 s of drifting.
    assert found.row * STEP == pytest.approx(6.65, abs=STEP + 1e-9)
    assert own_breach(ego, found.row - 1) is None


def test_an_ego_off_the_road() -> None:
    ego = ego_view(on_lane(motion=steady(0.0, -3.0, 10.0, steps=STEPS), lane_lateral=-3.0))
    assert own_breach(ego, 50) == OwnBreach(kind=Breach.OFF_ITS_SIDE, row=0)


@pytest.mark.parametrize(("light", "breach"), [(Light.RED, True), (Light.YELLOW, False)])
def test_an_ego_inside_a_junction_that_it_entered_on(light: Light, breach: bool) -> None:
    inside = TIME >= 5.0
    ego = ego_view(
        on_lane(
            motion=steady(447.75, 0.0, 10.0, steps=STEPS),
            lane=np.where(inside, CROSSING, EAST),
            light=light,
            light_distance=50.0 - 10.0 * TIME + 1e-6,
        )
    )
    found = own_breach(ego, 120)
    if not breach:
        assert found is None
        return
    assert found is not None
    assert found.kind is Breach.RED_LIGHT
    assert found.row * STEP == pytest.approx(5.05, abs=1e-9)
    assert own_breach(ego, 90) is None
