"""An agent that drives by PufferLib's driving policy.

The policy drives to a goal, a point that it was rewarded for approaching. Here goals are along
the route, one after the other; each corresponds to an episode of the training. Ten times a
second it chooses one of seven accelerations and one of thirteen steering angles, which move the ego
like the vehicles in its training. It knows neither traffic lights nor speed limits, so
this agent brakes for lights and limits the speed.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from drivora_service.agents.interface import AgentContext, Observation, PoseControl
from drivora_service.agents.light_braking import compile_braking, light_acceleration
from drivora_service.agents.plugin import read_agent_parameters
from drivora_service.agents.puffer_drive.encoding import SIZE_SHARE, compile_encoding, encode
from drivora_service.agents.puffer_drive.parameters import GOAL_DISTANCE, PufferDriveParameters
from drivora_service.agents.puffer_drive.policy import (
    ACCELERATIONS,
    OBSERVATION_SIZE,
    STEERINGS,
    DrivePolicy,
    DriveWeights,
)
from drivora_service.agents.puffer_drive.road import pieces_along
from drivora_service.agents.puffer_drive.weights import load_weights

_PERIOD = 0.1
"""Seconds between two decisions."""
_MEMORY = 9.1
"""Seconds after which the memory is cleared: the length of episodes in training."""
_ACCELERATION_SHARE = 0.5
"""Share of a chosen acceleration that takes effect, as in its training."""
_HARDEST = 4.0
"""Largest acceleration to choose, m/s²."""
_REACHED = 2.5
"""Metres from a goal at which it is reached; 2 m in training."""
_PASSED = 1.0
"""Metres before a goal on the route from which on the next one is shown in any case."""


class PufferDriveAgent:
    """The agent. One object drives one ego through one run."""

    def __init__(self, weights: DriveWeights, goal_distance: float = GOAL_DISTANCE) -> None:
        """Makes the agent.

        Args:
            weights: Weights of the policy.
            goal_distance: Metres along the route from one goal to the next.
        """
        self._policy = DrivePolicy(weights)
        self._goal_distance = goal_distance

    def setup_env(self, context: AgentContext) -> None:
        """Divides the road along the route into the pieces for the policy."""
        self._route = context.route
        last = context.route.line[-1] - context.route.line[-2]
        self._last_direction = last / np.hypot(*last)
        self._road = pieces_along(context.network, context.route)
        self._size = np.array([context.model.length, context.model.width])
        self._max_braking = min(context.model.max_deceleration, 9.81 * context.friction)
        self._step_length = context.step_length
        self._policy.forget()
        self._next_decision = -math.inf
        self._forget_at = -math.inf
        self._acceleration = self._steering = 0.0
        self._goal, self._goal_s = np.zeros(2), -math.inf
        self._seen = np.zeros(OBSERVATION_SIZE, dtype=np.float32)
        self._log = context.log
        self._log.declare("acceleration", "steering", "goal_x", "goal_y")

    def run_step(self, observation: Observation) -> PoseControl:
        """Returns the next pose by the policy's last decision, which is renewed when due."""
        if observation.time > self._next_decision - 1e-6:
            self._next_decision = observation.time + _PERIOD
            self._decide(observation)
        speed = max(observation.speed, 0.0)
        acceleration = _ACCELERATION_SHARE * self._acceleration
        dt = self._step_length
        acceleration = min(acceleration, (observation.speed_limit - speed) / dt)
        acceleration = min(acceleration, light_acceleration(observation, self._max_braking))
        row = self._log.row
        row[0], row[1] = acceleration, self._steering
        row[2], row[3] = self._goal
        speed = max(speed + acceleration * dt, 0.0)
        # The vehicle of its training: slip and turn are those of a bicycle of the shown length.
        x, y, yaw = observation.ego[:3].tolist()
        tangent = math.tan(self._steering)
        slip = math.tanh(0.5 * tangent)
        turn = speed * math.cos(slip) * tangent / (SIZE_SHARE * float(self._size[0])) * dt
        return PoseControl(
            x + speed * math.cos(yaw + slip) * dt,
            y + speed * math.sin(yaw + slip) * dt,
            yaw + turn,
            speed,
        )

    def _decide(self, observation: Observation) -> None:
        x, y = observation.ego[:2].tolist()
        is_there = math.hypot(self._goal[0] - x, self._goal[1] - y) < _REACHED
        if is_there or observation.route_s > self._goal_s - _PASSED:
            self._set_goal(observation.route_s + self._goal_distance)
            self._forget_at = observation.time
        if observation.time > self._forget_at - 1e-6:
            self._forget_at = observation.time + _MEMORY
            self._policy.forget()
        encode(
            observation.ego, observation.speed, self._size, self._goal, observation.objects,
            observation.object_sizes, self._road, self._seen,
        )  # fmt: skip
        logits = self._policy.logits(self._seen)
        acceleration = int(logits[:ACCELERATIONS].argmax())
        steering = int(logits[ACCELERATIONS:].argmax())
        middle, most = ACCELERATIONS // 2, STEERINGS // 2
        self._acceleration = _HARDEST * (acceleration - middle) / middle
        self._steering = (steering - most) / most

    def _set_goal(self, s: float) -> None:
        """Sets the goal on the route; beyond its end, straight on."""
        route = self._route
        for k in (0, 1):
            self._goal[k] = np.interp(s, route.arc, route.line[:, k])
        self._goal += max(s - route.length, 0.0) * self._last_direction
        self._goal_s = s


def create(parameters: Mapping[str, Any], folder: Path) -> PufferDriveAgent:
    """Makes the agent with the weights in ``folder``.

    Raises:
        AgentError: If a parameter is not allowed, or the weights cannot be used.
    """
    read = read_agent_parameters("puffer-drive", PufferDriveParameters, parameters)
    compile_encoding()
    compile_braking()
    return PufferDriveAgent(load_weights(folder), read.goal_distance)
