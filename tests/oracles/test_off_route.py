"""Verdicts of every oracle on an ego that has left its route."""

from __future__ import annotations

import numpy as np
import pytest

from drivora_service.observations.trace import TerminalEvent
from drivora_service.oracles.built_in import default_oracles
from drivora_service.oracles.verdict import Oracle, Outcome
from drivora_service.testing.traces import SyntheticEgo
from tests.oracles.streets import along, judge_on, on_network, steady, way
from tests.simulation.episodes import network

TOWN = network("tee-town")
MEANT_FOR_THE_ROUTE = {"route_deviation", "destination"}
ELSEWHERE = np.array([(-500.0, -500.0), (-400.0, -500.0)])
"""A route that the ego is nowhere near."""


def driver(*, speed: float, lateral: float, backwards: bool = False) -> SyntheticEgo:
    """Drives through an all-way stop, whatever its route is."""
    line = way(TOWN, "-market_2_0", "-market_1_0")
    motion = along(line[::-1] if backwards else line, steady(speed, 300))
    return on_network(TOWN, motion, route_lateral=lateral, route=ELSEWHERE, route_s=0.0)


def standing(lateral: float) -> SyntheticEgo:
    motion = along(way(TOWN, "-market_2_0", "-market_1_0"), np.full(1300, 40.0))
    return on_network(TOWN, motion, route_lateral=lateral, route=ELSEWHERE, route_s=0.0)


@pytest.mark.parametrize("oracle", default_oracles(), ids=lambda oracle: oracle.name)
def test_a_rule_says_the_same_off_the_route_as_on_it(oracle: Oracle) -> None:
    egos = [
        lambda lateral: driver(speed=18.0, lateral=lateral),
        lambda lateral: driver(speed=8.0, lateral=lateral, backwards=True),
        standing,
    ]
    for make in egos:
        on, off = (judge_on(TOWN, oracle, make(lateral)) for lateral in (0.0, 25.0))
        if oracle.name in MEANT_FOR_THE_ROUTE:
            assert {verdict.outcome for verdict in off} == {Outcome.VIOLATED} or make is standing
        else:
            assert [v.outcome for v in off] == [v.outcome for v in on]


@pytest.mark.parametrize(
    ("name", "make"),
    [
        ("speeding", lambda: driver(speed=18.0, lateral=25.0)),
        ("stop_sign", lambda: driver(speed=8.0, lateral=25.0)),
        ("wrong_way", lambda: driver(speed=8.0, lateral=25.0, backwards=True)),
        ("lane_keeping", lambda: driver(speed=8.0, lateral=25.0, backwards=True)),
        ("blocked", lambda: standing(25.0)),
        ("route_deviation", lambda: driver(speed=8.0, lateral=31.0)),
        ("destination", lambda: driver(speed=8.0, lateral=31.0)),
    ],
)
def test_oracles_are_violated_off_the_route_too(name: str, make: object) -> None:
    (oracle,) = (oracle for oracle in default_oracles() if oracle.name == name)
    assert callable(make)
    verdicts = judge_on(TOWN, oracle, make())
    assert {verdict.outcome for verdict in verdicts} == {Outcome.VIOLATED}


def test_an_ego_that_deviated_is_said_to_have() -> None:
    ego = driver(speed=8.0, lateral=31.0)
    ended = SyntheticEgo(
        **{
            **{name: getattr(ego, name) for name in ego.__dataclass_fields__},
            "end": TerminalEvent.ROUTE_DEVIATION,
        }
    )
    (oracle,) = (oracle for oracle in default_oracles() if oracle.name == "destination")
    assert judge_on(TOWN, oracle, ended)[0].evidence["reason"] == "route_deviation"
