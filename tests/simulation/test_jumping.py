"""Vehicles of SUMO that change lanes within one step, by LC2013, into an ego."""

from __future__ import annotations

from dataclasses import replace

import pytest

from drivora_service.metrics.built_in_metrics import measure
from drivora_service.observations.artefacts import ArtefactKind
from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import TerminalEvent
from drivora_service.oracles.built_in import default_oracles, judge_all
from drivora_service.oracles.verdict import Outcome
from drivora_service.oracles.verdicts.artefact_verdicts import find_artefact_verdicts
from drivora_service.scenario.model import AgentChoice, Scenario
from tests.simulation.episodes import car, contacts, ego, network, place, run, scenario

TOWN = "highway"
SPEED = 15.0


def beside_a_truck(right: float) -> Scenario:
    """An ego that straddles the line of a lane into which a truck changes beside it.

    For SUMO, the ego is on its own lane alone.
    """
    begin = 60.0
    times = [0.5 * n for n in range(30)]
    way = [place("eb_1_2", begin + SPEED * time, on=TOWN, right=right) for time in times]
    trajectory = [[time, point.x, point.y] for time, point in zip(times, way, strict=True)]
    driven = replace(
        ego(way[0], place("eb_1_2", 300, on=TOWN), initial_speed=SPEED),
        agent=AgentChoice(name="scripted", parameters={"trajectory": trajectory}),
    )
    ways = (place("eb_1_0", s, on=TOWN, speed=SPEED) for s in (begin + 5.0, 300.0))
    truck = replace(
        car(*ways, name="truck", behavior="sumo"), model="vehicle.carlamotors.european_hgv"
    )
    slow = car(
        *(place("eb_1_0", s, on=TOWN, speed=5.0) for s in (90.0, 300.0)),
        name="slow",
        behavior="replay",
    )
    return scenario(driven, on=TOWN, npc_vehicles=(truck, slow), seconds=12.0)


@pytest.mark.parametrize("right", [1.4, 1.7])
def test_a_truck_that_jumps_into_the_ego_costs_it_no_score(right: float) -> None:
    trace = run(beside_a_truck(right))
    assert contacts(trace) == [("ego", "truck")]
    assert trace.ego_ends[0] is TerminalEvent.COLLISION
    view = RunView(trace, network(TOWN))
    (driven,) = view.egos
    assert driven.artefact is not None
    assert driven.artefact.kind is ArtefactKind.JUMPED
    assert driven.artefact.distance > 3.0
    verdicts = judge_all(trace, network(TOWN), default_oracles(), view=view)
    (artefact,) = find_artefact_verdicts(verdicts)
    assert "truck jumped into the ego" in artefact.message
    violated = {v.oracle for v in verdicts if v.outcome is Outcome.VIOLATED}
    assert not violated & {"collision", "destination", "near_miss"}
    metrics = measure(trace, network(TOWN), verdicts, view=view)
    for name in ("driving_score", "success", "route_completion", "nuplan_closed_loop"):
        assert metrics[name] is None


def test_a_truck_that_jumps_past_the_ego_changes_nothing() -> None:
    trace = run(beside_a_truck(0.5))
    assert not contacts(trace)
    assert RunView(trace, network(TOWN)).egos[0].artefact is None
