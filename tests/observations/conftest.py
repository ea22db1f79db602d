from __future__ import annotations

import numpy as np
import pytest

from drivora_service.observations.trace import Contact, Light, LogEvent, Role, TerminalEvent, Trace
from drivora_service.testing.traces import Motion, SyntheticActor, SyntheticEgo, make_trace

STEPS = 80


@pytest.fixture
def full_trace() -> Trace:
    """A trace with everything in it."""
    return make_full_trace()


def make_full_trace() -> Trace:
    """Makes one: two egos, all roles, comings and goings, lights and logs."""
    rng = np.random.default_rng(7)
    k = np.arange(STEPS)
    egos = [
        SyntheticEgo(
            id="one",
            motion=Motion.along(0.4 * k, np.sin(k / 20.0)),
            lane=np.where(k < 40, 3, -1),
            lane_lateral=np.where(k < 40, rng.normal(0.0, 0.2, STEPS), np.nan),
            lane_heading=np.where(k < 40, 0.1, np.nan),
            speed_limit=13.9,
            light=np.where(k < 30, Light.RED, Light.NONE),
            light_distance=np.where(k < 30, 20.0 - 0.4 * k, np.nan),
            acceleration=rng.normal(0.0, 1.0, STEPS),
            steer=rng.normal(0.0, 0.05, STEPS),
            end=TerminalEvent.COLLISION,
            end_step=60,
            logs={"target_speed": np.where(k % 2 == 0, 8.0, np.nan)},
        ),
        SyntheticEgo(
            id="two",
            motion=Motion.steady(0.0, 9.0, steps=STEPS, speed=2.0),
            start_time=1.0,
            lane=5,
            logs={"gap": 0.25 * k},
        ),
    ]
    roles = (Role.NPC_VEHICLE, Role.NPC_WALKER, Role.NPC_OBSTACLE, Role.BACKGROUND)
    others = [
        SyntheticActor(
            id=f"actor-{role}",
            role=role,
            motion=Motion.steady(30.0, 4.0 * i, steps=STEPS, speed=float(i)),
            present=(k >= 10 * i) & (k < 70),
        )
        for i, role in enumerate(roles)
    ]
    trace = make_trace(
        egos,
        others,
        contacts=[Contact(step=60, ego=0, other=2)],
        lights={"junction": ["Gr" if i < 33 else "rG" for i in range(STEPS)]},
        log_events=[LogEvent(step=4, ego=1, message="Vorfahrt gewähren — “yield”")],
    )
    trace.meta["seed"] = 11
    trace.lane_ids.update({3: "north_0", 5: ":middle_1_0"})
    return trace
