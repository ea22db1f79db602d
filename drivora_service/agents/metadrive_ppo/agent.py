"""An agent that drives by MetaDrive's PPO expert.

The expert decides ten times a second, as it was trained. Its steering and throttle become the front
wheels' angle and the acceleration of MetaDrive's default vehicle; it knows neither
traffic lights nor speed limits, so this agent brakes for lights and limits the speed.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from drivora_service.agents.interface import AccelerationControl, AgentContext, Observation
from drivora_service.agents.light_braking import compile_braking, light_acceleration
from drivora_service.agents.metadrive_ppo.checkpoints import find_checkpoints
from drivora_service.agents.metadrive_ppo.encoding import (
    CHECKPOINT,
    LATER_CHECKPOINT,
    RoadCol,
    compile_encoding,
    encode_checkpoint,
    encode_ego,
    encode_others,
)
from drivora_service.agents.metadrive_ppo.policy import (
    OBSERVATION_SIZE,
    ExpertWeights,
    expert_action,
)
from drivora_service.agents.metadrive_ppo.weights import load_weights
from drivora_service.agents.plugin import NoParameters, read_agent_parameters
from drivora_service.agents.route_corridor import find_corridor

_PERIOD = 0.1
"""Seconds between two decisions."""
_MAX_STEERING = math.radians(40.0)
_WHEELBASE = 2.469
"""Metres between the axles of the vehicle that the expert was trained in."""
_DRIVE = 800.0 * 4.0 / 1100.0
"""m/s² at full throttle: 800 N per wheel, 1,100 kg."""
_BRAKE = 9.0
"""m/s² at full braking."""
_OVER_LIMIT = 1.0
"""m/s² of braking per m/s above the speed limit."""


class MetaDriveAgent:
    """The agent. One object drives one ego through one run."""

    def __init__(self, weights: ExpertWeights) -> None:
        """Args: weights: Weights of the expert."""
        self._weights = weights

    def setup_env(self, context: AgentContext) -> None:
        """Finds the road and the checkpoints along the route."""
        self._corridor = find_corridor(context.network, context.route)
        self._checkpoints = find_checkpoints(self._corridor)
        self._wheelbase = context.model.wheelbase
        self._max_braking = min(context.model.max_deceleration, 9.81 * context.friction)
        self._next_decision = -math.inf
        self._last = np.zeros(2)
        self._place = np.zeros(len(RoadCol))
        self._seen = np.zeros(OBSERVATION_SIZE)
        self._log = context.log
        self._log.declare("steering", "throttle", "checkpoint_distance")

    def run_step(self, observation: Observation) -> AccelerationControl:
        """Returns the control of the policy's last decision, which is renewed when due."""
        if observation.time > self._next_decision - 1e-6:
            self._next_decision = observation.time + _PERIOD
            self._decide(observation)
        steering, throttle = self._last.tolist()
        acceleration = _DRIVE * throttle if throttle >= 0.0 else _BRAKE * throttle
        over = observation.speed - observation.speed_limit
        if over > 0.0:
            acceleration = min(acceleration, -_OVER_LIMIT * over)
        elif over > -1.0:
            acceleration = min(acceleration, -_DRIVE * over)
        acceleration = min(acceleration, light_acceleration(observation, self._max_braking))
        # The same bend with another wheelbase.
        wheels = math.atan(math.tan(_MAX_STEERING * steering) * self._wheelbase / _WHEELBASE)
        row = self._log.row
        row[0], row[1], row[2] = steering, throttle, self._to_checkpoint
        return AccelerationControl(acceleration, wheels)

    def _decide(self, observation: Observation) -> None:
        s = observation.route_s
        corridor, checkpoints = self._corridor, self._checkpoints
        columns = (corridor.middle[:, 0], corridor.middle[:, 1], corridor.heading)
        for cell, column in zip((RoadCol.X, RoadCol.Y, RoadCol.DIRECTION), columns, strict=True):
            self._place[cell] = np.interp(s, corridor.arc, column)
        near = min(int(np.searchsorted(corridor.arc, s)), len(corridor.arc) - 1)
        self._place[RoadCol.WIDTH] = corridor.width[near]
        self._place[RoadCol.LANES] = corridor.lanes[near]
        last_piece = len(checkpoints.ends) - 1
        piece = min(int(np.searchsorted(checkpoints.ends, s, side="right")), last_piece)
        self._to_checkpoint = float(checkpoints.ends[piece] - s)

        ego, seen = observation.ego, self._seen
        encode_ego(ego, observation.speed, self._place, self._last, seen)
        encode_checkpoint(ego, checkpoints.pieces[piece], seen[CHECKPOINT])
        later = checkpoints.pieces[min(piece + 1, last_piece)]
        encode_checkpoint(ego, later, seen[LATER_CHECKPOINT])
        encode_others(
            ego, observation.objects, observation.object_sizes, observation.object_kinds, seen
        )
        action = expert_action(self._weights, seen.astype(np.float32))
        self._last[:] = np.clip(action, -1.0, 1.0)


def create(parameters: Mapping[str, Any], folder: Path) -> MetaDriveAgent:
    """Makes the agent with the weights in ``folder``.

    Raises:
        AgentError: If there are parameters, or the weights cannot be used.
    """
    read_agent_parameters("metadrive-ppo", NoParameters, parameters)
    compile_encoding()
    compile_braking()
    return MetaDriveAgent(load_weights(folder))
