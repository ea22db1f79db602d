"""An ego on a straight road, and metrics of traces that are built by hand."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from drivora_service.metrics.built_in_metrics import measure
from drivora_service.observations.run_view import EgoView, RunView
from drivora_service.observations.trace import Contact, TerminalEvent, Trace
from drivora_service.oracles.built_in import default_oracles, judge_all
from drivora_service.testing.networks import EAST, straight_road
from drivora_service.testing.traces import Motion, SyntheticActor, SyntheticEgo, make_trace

ROAD = straight_road()
DT = 0.05


def straight(speed: float, steps: int, x: float = 0.0, y: float = 0.0) -> Motion:
    """A motion east at a constant speed."""
    return Motion.steady(x, y, steps=steps, speed=speed)


def at_speeds(speeds: Sequence[float] | np.ndarray[Any, Any]) -> Motion:
    """A motion east with the given speed in each step, from x = 0."""
    return Motion.along(np.concatenate(([0.0], np.cumsum(speeds)[:-1])) * DT, 0.0, yaw=0.0)


def ego_on_road(motion: Motion, length: float, **fields: Any) -> SyntheticEgo:
    """An ego in the lane, on a route of some metres from x = 0, that arrives unless told other."""
    defaults: dict[str, Any] = {
        "motion": motion,
        "lane": EAST,
        "lane_lateral": 0.0,
        "lane_heading": 0.0,
        "speed_limit": 10.0,
        "route": np.array([(0.0, 0.0), (length, 0.0)]),
        "route_s": motion.states[:, 0],
        "end": TerminalEvent.ARRIVED,
    }
    return SyntheticEgo(**{**defaults, **fields})


def trace_of(ego: SyntheticEgo, *others: SyntheticActor, contacts: Sequence[Contact] = ()) -> Trace:
    return make_trace([ego], others, contacts=contacts)


def view_of(ego: SyntheticEgo, *others: SyntheticActor) -> EgoView:
    return RunView(trace_of(ego, *others), ROAD).egos[0]


def values_of(
    ego: SyntheticEgo, *others: SyntheticActor, contacts: Sequence[Contact] = ()
) -> dict[str, float | None]:
    """The metrics of a trace, judged by all oracles."""
    trace = trace_of(ego, *others, contacts=contacts)
    return measure(trace, ROAD, judge_all(trace, ROAD, default_oracles()))
