"""The stop signs of a route, against the oracle that looks for them in recorded positions."""

from __future__ import annotations

import pytest

from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import Col
from drivora_service.oracles.stop_sign import StopSign
from drivora_service.oracles.verdict import Outcome
from drivora_service.scenario.documents import document_text
from drivora_service.scenario.seed_generation import generate_seeds
from drivora_service.scenario.validation import validate_data
from drivora_service.simulation.planning import plan_episode
from tests.simulation.episodes import Blind, catalogue, network, row_of, run


@pytest.mark.parametrize("town", ["tee-town", "old-town", "signal-grid"])
def test_an_ego_that_never_stops_runs_each_of_them(town: str) -> None:
    road, found = network(town), 0
    seeds = generate_seeds(road, count=8, min_length=100, max_length=400, seed=3, agent="idm")
    for seed in seeds:
        scenario = validate_data(document_text(seed).encode(), catalogue(), None).scenario
        route = plan_episode(scenario, road).egos[0].route
        trace = run(scenario, Blind(8.0))
        ran = [
            verdict
            for verdict in StopSign().judge(RunView(trace, road))
            if verdict.outcome is Outcome.VIOLATED
        ]
        assert len(ran) == len(route.stop_signs)
        found += len(ran)
        for verdict, s in zip(ran, route.stop_signs, strict=True):
            assert verdict.step is not None
            x, y = trace.states[verdict.step, row_of(trace, "ego_0"), [Col.X, Col.Y]]
            place = abs(route.line - (x, y)).sum(axis=1).argmin()
            # The front passes the line half a length (2.5 m) before the centre does.
            assert route.arc[place] + 2.5 == pytest.approx(s, abs=1.5)
    assert found
