"""Short ways to say what the tests of this room say often."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import Contact
from drivora_service.oracles.verdict import Oracle, Outcome, Verdict
from drivora_service.testing.networks import EAST, straight_road
from drivora_service.testing.traces import SyntheticActor, SyntheticEgo, make_trace

ROAD = straight_road()


def on_lane(**fields: Any) -> SyntheticEgo:
    """An ego in the middle of the lane that leads east, unless told otherwise."""
    defaults: Mapping[str, Any] = {
        "lane": EAST,
        "lane_lateral": 0.0,
        "lane_heading": 0.0,
        "speed_limit": 10.0,
        "route": np.array([(0.0, 0.0), (400.0, 0.0)]),
    }
    return SyntheticEgo(**{**defaults, **fields})


def judge(
    oracle: Oracle,
    *egos: SyntheticEgo,
    others: Sequence[SyntheticActor] = (),
    contacts: Sequence[Contact] = (),
    step_length: float = 0.05,
    max_sim_time: float = 120.0,
) -> tuple[Verdict, ...]:
    trace = make_trace(
        egos, others, contacts=contacts, step_length=step_length, max_sim_time=max_sim_time
    )
    return oracle.judge(RunView(trace, ROAD))


def outcomes(verdicts: Sequence[Verdict]) -> list[Outcome]:
    return [verdict.outcome for verdict in verdicts]
