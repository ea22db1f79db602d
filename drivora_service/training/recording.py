"""Recording what an expert does, also from where it would not have come by itself.

A hand jerks the wheel and a pedal now and then, so that the expert shows how to get back (Laskey,
Lee, Fox, Dragan, Goldberg 2017: *DART: Noise Injection for Robust Imitation Learning*); or the
agent that is trained drives for a while.
Only what the expert does while it has the wheel is learned from.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from drivora_service.agents.imitation.agent import View
from drivora_service.agents.imitation.waypoints import INTERVAL, WAYPOINTS
from drivora_service.agents.interface import (
    AccelerationControl,
    Agent,
    AgentContext,
    Control,
    Observation,
)
from drivora_service.agents.log import AgentLog
from drivora_service.geometry.arrays import BoolArray, Float32Array
from drivora_service.observations.trace import Col, TerminalEvent
from drivora_service.simulation.episode import Episode
from drivora_service.simulation.plan import EpisodePlan

_PERIOD = 0.2
"""Seconds between two samples."""
_GUILT = 3.0
"""Seconds before a collision from which nothing is learned."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Samples:
    """What was seen, and where the ego went from there.

    Attributes:
        seen: (n, K) what the network takes.
        waypoints: (n, 4, 2) where the ego was after each half second, in the frame that it had,
            metres; 0 where not known.
        known: (n, 4) whether the expert drove until then.
    """

    seen: Float32Array
    waypoints: Float32Array
    known: BoolArray


class Deviation(Protocol):
    """Somebody who drives in the expert's place."""

    def setup_env(self, context: AgentContext) -> None:
        """Prepares for a run."""
        ...

    def begin(self, random: np.random.Generator) -> float:
        """Takes the wheel; gives for how many seconds."""
        ...

    def drive(self, observation: Observation, expert: AccelerationControl) -> Control:
        """Drives a step; called also while the expert has the wheel."""
        ...


class Jerks:
    """A hand that pulls at the wheel and steps on a pedal for a moment."""

    def setup_env(self, context: AgentContext) -> None:  # noqa: ARG002  # needed by others
        """Prepares for a run."""
        self._steer = self._acceleration = 0.0

    def begin(self, random: np.random.Generator) -> float:
        """Draws how it pulls."""
        self._steer = float(random.normal(0.0, 0.06))
        self._acceleration = float(random.normal(0.0, 1.2))
        return float(random.uniform(0.5, 1.8))

    def drive(self, observation: Observation, expert: AccelerationControl) -> Control:
        """Adds to what the expert does."""
        # At speed the same pull would throw the car off the road.
        steer = self._steer * min(1.0, 5.0 / max(observation.speed, 1.0))
        return AccelerationControl(expert.acceleration + self._acceleration, expert.steer + steer)


class Learner:
    """The agent that is to be trained, as far as it has come: it shows where it goes wrong.

    Ross, Gordon, Bagnell: *A Reduction of Imitation Learning and Structured Prediction to No-Regret
    Online Learning* (AISTATS 2011), with turns in place of a mixture.
    """

    def __init__(self, agent: Agent) -> None:
        """Args: agent: Drives one run."""
        self._agent = agent

    def setup_env(self, context: AgentContext) -> None:
        """Prepares for a run."""
        # The log of the run is the expert's.
        self._agent.setup_env(replace(context, log=AgentLog()))

    def begin(self, random: np.random.Generator) -> float:
        """Drives for long: what goes wrong may take its time."""
        return float(random.uniform(4.0, 20.0))

    def drive(self, observation: Observation, expert: AccelerationControl) -> Control:  # noqa: ARG002  # not followed
        """Drives as it has learned to."""
        return self._agent.run_step(observation)


class Recorder:
    """An agent that lets an expert drive, and somebody else in between, and keeps what was seen."""

    def __init__(self, expert: Agent, view: View, deviation: Deviation | None, seed: int) -> None:
        """Makes the recorder.

        Args:
            expert: Answers with ``AccelerationControl``.
            view: What the network will see.
            deviation: Who drives in between, if anybody.
            seed: Of who drives when.
        """
        self._expert = expert
        self._view = view
        self._deviation = deviation
        self._random = np.random.default_rng(seed)

    def setup_env(self, context: AgentContext) -> None:
        """Prepares everybody for a run."""
        self._expert.setup_env(context)
        self._view.setup_env(context)
        if self._deviation is not None:
            self._deviation.setup_env(context)
        self._step_length = context.step_length
        self._every = max(round(_PERIOD / context.step_length), 1)
        self._poses: list[tuple[float, float, float]] = []
        self._expert_drove: list[bool] = []
        self._seen: list[Float32Array] = []
        self._at: list[int] = []
        self._deviating = False
        self._until = float(self._random.uniform(0.0, 4.0))

    def run_step(self, observation: Observation) -> Control:
        """Lets drive whose turn it is."""
        control = self._expert.run_step(observation)
        if not isinstance(control, AccelerationControl):
            raise TypeError(f"the expert answers with {type(control).__name__}")
        self._view.follow(observation)
        x, y, yaw = observation.ego[: Col.VX].tolist()
        if len(self._poses) % self._every == 0:
            self._view.look(observation)
            self._seen.append(self._view.seen.copy())
            self._at.append(len(self._poses))
        self._poses.append((x, y, yaw))
        answer: Control = control
        if self._deviation is not None:
            if observation.time >= self._until:
                self._deviating = not self._deviating
                lasts = self._random.uniform(2.5, 5.0)
                if self._deviating:
                    lasts = self._deviation.begin(self._random)
                self._until = observation.time + float(lasts)
            other = self._deviation.drive(observation, control)
            if self._deviating:
                answer = other
        self._expert_drove.append(not self._deviating)
        return answer

    def samples(self, *, collided: bool) -> Samples:
        """Returns what was recorded in the run that is over.

        Args:
            collided: Whether it ended by a collision; its last seconds are left out then.
        """
        steps = len(self._poses)
        usable = steps - round(_GUILT / self._step_length) if collided else steps
        poses, apart = np.array(self._poses), round(INTERVAL / self._step_length)
        # How many steps from here on the expert has the wheel.
        left = np.zeros(steps + 1, dtype=np.int64)
        for k in range(steps - 1, -1, -1):
            left[k] = left[k + 1] + 1 if self._expert_drove[k] else 0
        at = np.array([k for k in self._at if k < usable and left[k] >= apart], dtype=np.int64)
        rows = np.searchsorted(self._at, at)
        waypoints = np.zeros((len(at), WAYPOINTS, 2), dtype=np.float32)
        known = np.zeros((len(at), WAYPOINTS), dtype=np.bool_)
        cos, sin = np.cos(poses[at, 2]), np.sin(poses[at, 2])
        for k in range(WAYPOINTS):
            later = at + (k + 1) * apart
            known[:, k] = (left[at] >= (k + 1) * apart) & (later < steps)
            there = poses[np.minimum(later, steps - 1)] - poses[at]
            waypoints[:, k, 0] = there[:, 0] * cos + there[:, 1] * sin
            waypoints[:, k, 1] = there[:, 1] * cos - there[:, 0] * sin
        waypoints[~known] = 0.0
        useful = known[:, 0]
        seen = np.array([self._seen[row] for row in rows[useful]], dtype=np.float32)
        seen = seen.reshape(int(useful.sum()), len(self._view.seen))
        return Samples(seen=seen, waypoints=waypoints[useful], known=known[useful])


def record(plan: EpisodePlan, recorder: Recorder) -> Samples:
    """Drives a run with one ego and gives what was recorded."""
    episode = Episode(plan, [recorder])
    while not episode.done:
        episode.step()
    ends = episode.finish().ego_ends
    return recorder.samples(collided=TerminalEvent.COLLISION in ends)


def join(parts: list[Samples]) -> Samples:
    """Puts samples of several runs together, in order."""
    return Samples(
        seen=np.concatenate([part.seen for part in parts]),
        waypoints=np.concatenate([part.waypoints for part in parts]),
        known=np.concatenate([part.known for part in parts]),
    )
