"""Playing a whole game with an adversary that came with a run."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from drivora_service.adversaries.game import Game
from drivora_service.observations.trace import Trace
from drivora_service.runs.adversary import (
    ACTIONS,
    DECISIONS,
    OBSERVATIONS,
    AdversarySource,
    action_values,
    layers_from_text,
)
from drivora_service.scenario.model import Scenario
from drivora_service.simulation.episode import Episode

_DIGITS = 6

Table = tuple[tuple[float, ...], ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Played:
    """A game that was played to its end.

    Attributes:
        scenario: The scenario with what the adversary did.
        trace: Trace of the episode.
        tables: ``OBSERVATIONS`` and ``DECISIONS``, from which a policy can be trained.
    """

    scenario: Scenario
    trace: Trace
    tables: Mapping[str, Table]


def play(
    episode: Episode,
    source: AdversarySource,
    on_intervention: Callable[[Scenario], None] = lambda _scenario: None,
) -> Played:
    """Plays an episode against an adversary.

    The same episode and the same adversary give the same game.

    Args:
        episode: The episode before its first step, made without ``holding``.
        source: The adversary.
        on_intervention: Called with the scenario so far after each decision with an effect.

    Raises:
        AgentError: An agent fails.
        SearchError: The policy cannot be read.
        SimulatorError: SUMO fails.
    """
    layers = layers_from_text(source.policy) if source.policy else ()
    random = np.random.default_rng(source.seed)
    game = Game(episode, interval=source.interval)
    observations = [game.observation]
    decisions: list[tuple[float, ...]] = []
    while not game.is_over:
        # Both are drawn always, so that a draw does not depend on those before.
        by_lot, any_action = random.random() < source.exploration, random.integers(len(ACTIONS))
        if by_lot or not layers:
            action = int(any_action)
        else:
            action = int(np.argmax(action_values(layers, game.observation)))
        outcome = game.decide(action)
        observations.append(outcome.observation)
        decisions.append((float(action), round(outcome.reward, _DIGITS), float(outcome.ended)))
        if outcome.intervention.has_effect:
            on_intervention(game.scenario)
    trace = game.finish()
    return Played(
        scenario=game.scenario,
        trace=trace,
        tables={
            OBSERVATIONS: tuple(tuple(view.tolist()) for view in observations),
            DECISIONS: tuple(decisions),
        },
    )
