"""Policies of the SMARTS contest behind the protocol."""

from __future__ import annotations

import sys

import numpy as np
import torch

from drivora_service.agents.adapters.reference import find_reference
from drivora_service.agents.adapters.smarts_agents.acting import (
    PERIOD,
    Target,
    allowed_speed,
    pose_of,
    step_towards,
    target_of,
)
from drivora_service.agents.adapters.smarts_agents.facing import make_facing
from drivora_service.agents.adapters.smarts_agents.observing import Observer
from drivora_service.agents.adapters.smarts_agents.policies import LOADERS
from drivora_service.agents.adapters.smarts_agents.scene import to_yaw
from drivora_service.agents.interface import Observation, PoseControl
from drivora_service.agents.remote.serving import serve
from drivora_service.agents.remote.views import ContextView
from drivora_service.observations.trace import Col

_GOAL_AHEAD = 45.0
"""Metres; within the fifty of the observation, so that the lane to it is known."""

_REMEMBERS = "iamp"
"""The policy that stores places of the last second, which needs one frame for the whole run."""


class SmartsAdapter:
    """Runs a policy ten times a second."""

    def __init__(self, policy: str) -> None:
        """Args: policy: Name of ``LOADERS``."""
        # More threads would change the order of sums, and the last digits.
        torch.set_num_threads(1)
        self._name = policy
        self._make_policy = LOADERS[policy]()

    def setup_env(self, context: ContextView) -> None:
        """Finds the ways along the route."""
        # A package draws unused random numbers; seeded here, so that runs are independent.
        np.random.seed(context.seed % 2**32)  # noqa: NPY002 # the packages' generator
        self._policy = self._make_policy()
        self._observer = Observer(context, _GOAL_AHEAD)
        self._driven = 0.0
        self._reference = find_reference(context.route, context.lanes)
        self._step_length = context.step_length
        self._target: Target | None = None
        self._log = context.log
        self._log.declare("target_speed", "allowed_speed", "lanes_shown")

    def run_step(self, observation: Observation) -> PoseControl:
        """Returns the pose of this step towards the policy's last answer."""
        target = self._target
        if target is None or observation.time > target.time + PERIOD - 1e-6:
            target = self._target = self._decide(observation)
        allowed = allowed_speed(self._reference, observation)
        self._log.row[1] = allowed
        return step_towards(target, observation, self._step_length, allowed)

    def _decide(self, observation: Observation) -> Target:
        scene = self._observer.observe(observation)
        self._driven += scene.distance_travelled
        if self._name == _REMEMBERS:
            x, y, heading = pose_of(self._policy.act(scene))
        else:
            frame = make_facing(scene, self._driven)
            x, y, heading = frame.restore_pose(
                *pose_of(self._policy.act(frame.transform_scene(scene)))
            )
        away = np.hypot(x - observation.ego[Col.X], y - observation.ego[Col.Y])
        self._log.row[0] = away / PERIOD
        self._log.row[2] = len(scene.waypoint_paths)
        return target_of(observation, x, y, to_yaw(heading))


if __name__ == "__main__":
    which = sys.argv[1]
    serve(lambda: SmartsAdapter(which), name=f"smarts-{which}")
