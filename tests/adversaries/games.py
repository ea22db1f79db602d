"""Episodes against an adversary, for tests."""

from __future__ import annotations

from typing import Any

from drivora_service.adversaries.adversary_situation import Situation, situation_of
from drivora_service.adversaries.game import Game
from drivora_service.agents.interface import Agent
from drivora_service.runs.adversary import ACTIONS, Action
from drivora_service.scenario.model import Scenario
from drivora_service.simulation.episode import Episode
from tests.simulation.episodes import ROAD, ego, place, scenario, start

NUMBER = {action: number for number, action in enumerate(ACTIONS)}


def alone(*, seconds: float | None = 30.0, speed: float = 8.0, **more: Any) -> Scenario:
    """One ego on a road of one lane a direction."""
    return scenario(
        ego(place(ROAD, 5), place(ROAD, 120), initial_speed=speed), seconds=seconds, **more
    )


def game(what: Scenario, *agents: Agent, interval: float = 4.0) -> Game:
    return Game(start(what, *agents), interval=interval)


def now(episode: Episode, number: int = 0) -> Situation:
    """The present situation of an ego that is in the world."""
    found = situation_of(episode, number)
    assert found is not None
    return found


def decide(playing: Game, action: Action) -> Any:
    return playing.decide(NUMBER[action])
