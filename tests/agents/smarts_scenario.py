"""The scenario in which the SMARTS policies' reference was recorded."""

from __future__ import annotations

from drivora_service.scenario.model import Scenario
from tests.simulation.episodes import car, ego, place, scenario


def smarts_scenario(seconds: float, agent: str = "idm") -> Scenario:
    """Round a bend and on, between a car ahead and one behind."""
    route = (place("harbour_0_0", 120), place("harbour_1_0", 60), place("ferry_1_0", 60))
    return scenario(
        ego(*route, agent=agent, initial_speed=6.0),
        npc_vehicles=(
            car(place("harbour_0_0", 145), place("harbour_1_0", 120), name="ahead"),
            car(place("harbour_0_0", 95), place("harbour_1_0", 120), name="behind"),
        ),
        step_length=0.1,
        seconds=seconds,
    )
