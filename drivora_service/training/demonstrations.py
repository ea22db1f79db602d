"""Recording of an expert's driving, also from states that it would not reach by itself.

Random disturbances of the steering wheel and a pedal make the expert show recoveries (Laskey, Lee,
Fox, Dragan, Goldberg 2017: *DART: Noise Injection for Robust Imitation Learning*); or the agent in
training drives for a while. Only the expert's own driving is used for training.
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
from drivora_service.geometry.array_shapes import BoolArray, Float32Array
from drivora_service.observations.trace import Col, TerminalEvent
from drivora_service.simulation.episode import Episode
from drivora_service.simulation.plans.episode_plan import EpisodePlan

_PERIOD = 0.2
"""Seconds between two samples."""
_GUILT = 3.0
"""Seconds before a collision that are not used for training."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Samples:
    """Network inputs, and the ego's places after them.

    Attributes:
        seen: (n, K) inputs of the network.
        waypoints: (n, 4, 2) the ego's places after each half second, in its frame of the sample,
            metres; 0 if unknown.
        known: (n, 4) whether the expert drove until then.
    """

    seen: Float32Array
    waypoints: Float32Array
    known: BoolArray


class PerturbingDriver(Protocol):
    """A perturbing driver, which drives instead of the expert for some time."""

    def setup_env(self, context: AgentContext) -> None:
        """Prepares for a run."""
        ...

    def begin(self, random: np.random.Generator) -> float:
        """Begins to drive; returns for how many seconds."""
        ...

    def drive(self, observation: Observation, expert: AccelerationControl) -> Control:
        """Returns the control of a step; also called while the expert drives."""
        ...


class Jerks:
    """Short random disturbances of steering and acceleration."""

    def setup_env(self, context: AgentContext) -> None:  # noqa: ARG002  # needed by others
        """Prepares for a run."""
        self._steer = self._acceleration = 0.0

    def begin(self, random: np.random.Generator) -> float:
        """Draws the disturbance."""
        self._steer = float(random.normal(0.0, 0.06))
        self._acceleration = float(random.normal(0.0, 1.2))
        return float(random.uniform(0.5, 1.8))

    def drive(self, observation: Observation, expert: AccelerationControl) -> Control:
        """Adds the disturbance to the expert's control."""
        # At high speed the same angle would move the car off the road.
        steer = self._steer * min(1.0, 5.0 / max(observation.speed, 1.0))
        return AccelerationControl(expert.acceleration + self._acceleration, expert.steer + steer)


class Learner:
    """The agent in its present state of training, which reaches states of its own errors.

    Ross, Gordon, Bagnell: *A Reduction of Imitation Learning and Structured Prediction to No-Regret
    Online Learning* (AISTATS 2011), with alternation instead of a mixture.
    """

    def __init__(self, agent: Agent) -> None:
        """Args: agent: The agent, for one run."""
        self._agent = agent

    def setup_env(self, context: AgentContext) -> None:
        """Prepares for a run."""
        # The log of the run is the expert's.
        self._agent.setup_env(replace(context, log=AgentLog()))

    def begin(self, random: np.random.Generator) -> float:
        """Draws a long duration, in which errors can develop."""
        return float(random.uniform(4.0, 20.0))

    def drive(self, observation: Observation, expert: AccelerationControl) -> Control:  # noqa: ARG002  # not followed
        """Returns the agent's own control."""
        return self._agent.run_step(observation)


class Recorder:
    """An agent that alternates an expert and a perturbing driver, and records samples."""

    def __init__(
        self, expert: Agent, view: View, perturbing: PerturbingDriver | None, seed: int
    ) -> None:
        """Makes the recorder.

        Args:
            expert: Expert, whose controls are ``AccelerationControl``.
            view: View of the network.
            perturbing: Perturbing driver, or ``None``.
            seed: Seed of the alternation.
        """
        self._expert = expert
        self._view = view
        self._perturbing = perturbing
        self._random = np.random.default_rng(seed)

    def setup_env(self, context: AgentContext) -> None:
        """Prepares expert, view and perturbing driver for a run."""
        self._expert.setup_env(context)
        self._view.setup_env(context)
        if self._perturbing is not None:
            self._perturbing.setup_env(context)
        self._step_length = context.step_length
        self._every = max(round(_PERIOD / context.step_length), 1)
        self._poses: list[tuple[float, float, float]] = []
        self._expert_drove: list[bool] = []
        self._seen: list[Float32Array] = []
        self._at: list[int] = []
        self._deviating = False
        self._until = float(self._random.uniform(0.0, 4.0))

    def run_step(self, observation: Observation) -> Control:
        """Returns the control of the present driver."""
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
        if self._perturbing is not None:
            if observation.time >= self._until:
                self._deviating = not self._deviating
                lasts = self._random.uniform(2.5, 5.0)
                if self._deviating:
                    lasts = self._perturbing.begin(self._random)
                self._until = observation.time + float(lasts)
            other = self._perturbing.drive(observation, control)
            if self._deviating:
                answer = other
        self._expert_drove.append(not self._deviating)
        return answer

    def samples(self, *, collided: bool) -> Samples:
        """Returns the samples of the finished run.

        Args:
            collided: Whether it ended by a collision; its last seconds are then omitted.
        """
        steps = len(self._poses)
        usable = steps - round(_GUILT / self._step_length) if collided else steps
        poses, apart = np.array(self._poses), round(INTERVAL / self._step_length)
        # Number of steps from here on in which the expert drives.
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
    """Runs a plan with one ego and returns the samples."""
    episode = Episode(plan, [recorder])
    while not episode.done:
        episode.step()
    ends = episode.finish().ego_ends
    return recorder.samples(collided=TerminalEvent.COLLISION in ends)


def join(parts: list[Samples]) -> Samples:
    """Concatenates samples of several runs, in order."""
    return Samples(
        seen=np.concatenate([part.seen for part in parts]),
        waypoints=np.concatenate([part.waypoints for part in parts]),
        known=np.concatenate([part.known for part in parts]),
    )
