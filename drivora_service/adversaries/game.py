"""An episode as a game of an adversary, which decides and is rewarded some seconds later.

The reward is that of DeepCollision: 1 for a collision of the ego; else the greatest probability of
one since the decision, if that is at least ``LEAST_PROBABILITY``, and else -1.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from drivora_service.adversaries.adversary_situation import EGO, situation_of
from drivora_service.adversaries.adversary_view import view_of
from drivora_service.adversaries.intervening import Intervention, intervene
from drivora_service.errors import SimulatorError
from drivora_service.feedback.collision_probability import collision_probability
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.observations.trace import TerminalEvent, Trace
from drivora_service.runs.adversary import ACTIONS, EXTENSION
from drivora_service.scenario.canonical import scenario_sha256
from drivora_service.scenario.model import Scenario
from drivora_service.simulation.episode import Episode

LEAST_PROBABILITY = 0.2


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Outcome:
    """What came of a decision.

    Attributes:
        observation: (39,) view of the situation after it.
        reward: The reward.
        ended: Whether the ego's part has ended.
        out_of_time: Whether the episode has ended before the ego's part, by its time limit.
        intervention: What was added or changed.
    """

    observation: FloatArray
    reward: float
    ended: bool
    out_of_time: bool
    intervention: Intervention


class Game:
    """One episode against an adversary."""

    def __init__(self, episode: Episode, *, interval: float) -> None:
        """Takes an episode before its first step.

        Args:
            episode: The episode, made without ``holding``.
            interval: Seconds of simulation between two decisions.
        """
        self.episode = episode
        self._steps = max(round(interval / episode.plan.scenario.step_length), 1)
        self._interventions: list[Intervention] = []
        self._number = 0
        self.observation = view_of(episode, situation_of(episode, 0))

    @property
    def is_over(self) -> bool:
        """Whether there is nothing left to decide: the ego's part or the episode has ended."""
        return self.episode.done or self._ending is not None

    @property
    def _ending(self) -> TerminalEvent | None:
        return self.episode.ending(EGO)

    @property
    def scenario(self) -> Scenario:
        """The scenario with all that was done: an episode of it is this run, without adversary."""
        scenario = self.episode.scenario
        told = [one.to_json() for one in self._interventions]
        known = list(self.episode.plan.scenario.extensions.get(EXTENSION, ()))
        if not told:
            return scenario
        return replace(scenario, extensions={**scenario.extensions, EXTENSION: known + told})

    def decide(self, action: int) -> Outcome:
        """Does an action, and lets the episode go on until the next decision.

        Args:
            action: Place of the action among ``ACTIONS``.

        Raises:
            SimulatorError: There is nothing left to decide.
        """
        episode = self.episode
        if self.is_over:
            raise SimulatorError("the game has ended: begin a new one")
        situation = situation_of(episode, self._number)
        self._number += 1
        if situation is None:
            raise SimulatorError("the ego has left the world before its part ended")
        done = intervene(episode, situation, ACTIONS[action])
        if done.has_effect:
            self._interventions.append(done)
        return self._go_on(done)

    def _go_on(self, done: Intervention) -> Outcome:
        episode = self.episode
        first = episode.row + 1
        for _ in range(self._steps):
            episode.step()
            if self.is_over:
                break
        ending = self._ending
        # That the ego has run out of time is no end that the adversary has brought about.
        out_of_time = ending is TerminalEvent.TIME_LIMIT
        self.observation = view_of(episode, situation_of(episode, self._number))
        return Outcome(
            observation=self.observation,
            reward=self._reward(first, ending),
            ended=ending is not None and not out_of_time,
            out_of_time=out_of_time,
            intervention=done,
        )

    def _reward(self, first: int, ending: TerminalEvent | None) -> float:
        if ending is TerminalEvent.COLLISION:
            return 1.0
        frames = self.episode.frames(first)
        risks = collision_probability(frames.states, frames.present, self.episode.actors, EGO)
        risk = float(np.max(risks, initial=0.0))
        return risk if risk >= LEAST_PROBABILITY else -1.0

    def finish(self) -> Trace:
        """Runs the episode to its end, without further actions, and returns its trace."""
        while not self.episode.done:
            self.episode.step()
        trace = self.episode.finish()
        return replace(trace, scenario_sha256=scenario_sha256(self.scenario))
