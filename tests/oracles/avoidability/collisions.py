"""Collisions with a known answer, for the tests of this room."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from drivora_service.geometry.boxes import boxes_overlap
from drivora_service.observations.run_view import EgoView, RunView
from drivora_service.observations.trace import Col, Contact, Trace
from drivora_service.oracles.avoidability.assess import Avoidability, assess
from drivora_service.oracles.avoidability.replayed_contact import Replay, cut_out
from drivora_service.testing.networks import straight_road
from drivora_service.testing.traces import Motion, SyntheticActor, SyntheticEgo, make_trace
from tests.oracles.judging import on_lane

STEP = 0.05
LENGTH, WIDTH = 4.5, 1.8
FAST = 40.0
"""A speed limit that no ego of these tests reaches, m/s."""
ROAD = straight_road()


def steady(x: float, y: float, speed: float = 0.0, yaw: float = 0.0, steps: int = 400) -> Motion:
    return Motion.steady(x, y, steps=steps, speed=speed, yaw=yaw)


def moving(x: Any, y: Any = 0.0, **more: Any) -> Motion:
    """Moves through positions, one a step."""
    return Motion.along(np.asarray(x, dtype=float), y, **more)


def collision(
    ego: Motion | SyntheticEgo, *others: Motion | SyntheticActor, friction: float | None = 1.0
) -> Trace:
    """A run that ends with the ego's first contact; the trace goes no further."""
    driver = on_lane(motion=ego, speed_limit=FAST) if isinstance(ego, Motion) else ego
    actors = [
        other if isinstance(other, SyntheticActor) else SyntheticActor(motion=other, id=f"npc_{i}")
        for i, other in enumerate(others)
    ]
    trace = make_trace([driver], actors)
    step, row = _first_contact(trace)
    rows = slice(0, step + 1)
    return replace(
        trace,
        times=trace.times[rows],
        states=trace.states[rows],
        present=trace.present[rows],
        ego_values=trace.ego_values[rows],
        ego_lanes=trace.ego_lanes[rows],
        ego_lights=trace.ego_lights[rows],
        light_states=trace.light_states[rows],
        log_values=trace.log_values[rows],
        contacts=(Contact(step=step, ego=0, other=row),),
        ego_end_steps=(step,),
        meta={} if friction is None else {"friction": friction},
    )


def _first_contact(trace: Trace) -> tuple[int, int]:
    for step in range(trace.step_count):
        for other in trace.actors[1:]:
            poses = [
                (*trace.states[step, actor.row, [Col.X, Col.Y, Col.YAW]], actor.length, actor.width)
                for actor in (trace.actors[0], other)
            ]
            if trace.present[step, other.row] and boxes_overlap(*poses[0], *poses[1]):
                return step, other.row
    raise AssertionError("no actor is touched")


def view(trace: Trace) -> EgoView:
    return RunView(trace, ROAD).egos[0]


def cut(trace: Trace) -> Replay:
    (contact,) = trace.contacts
    return cut_out(view(trace), contact.step, contact.other)


def assessed(trace: Trace) -> Avoidability:
    (contact,) = trace.contacts
    return assess(view(trace), contact.step, contact.other)


def standing_at(distance: float, speed: float, seconds: float = 20.0) -> tuple[Motion, Motion]:
    """An ego at a speed, and a vehicle standing ``distance`` metres before its front."""
    steps = round(seconds / STEP)
    return (
        steady(0.0, 0.0, speed, steps=steps),
        steady(LENGTH + distance, 0.0, steps=steps),
    )
