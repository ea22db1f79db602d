"""Agents with a network that was trained here, whose waypoints are followed."""

from __future__ import annotations

import math
from typing import Protocol

from drivora_service.agents.imitation.waypoints import WAYPOINTS, drive_waypoints
from drivora_service.agents.interface import AccelerationControl, AgentContext, Observation
from drivora_service.geometry.array_shapes import Float32Array

_PERIOD = 0.1
"""Seconds between two decisions."""


class View(Protocol):
    """The inputs of a network.

    Attributes:
        seen: The inputs, after ``look``; the same array throughout a run.
    """

    seen: Float32Array

    def setup_env(self, context: AgentContext) -> None:
        """Resets the state; called once, before the first step of a run."""
        ...

    def follow(self, observation: Observation) -> None:
        """Updates the state; called once in every step."""
        ...

    def look(self, observation: Observation) -> None:
        """Fills ``seen``; called if a decision is due, after ``follow``."""
        ...


class Network(Protocol):
    """A trained network."""

    def waypoints(self, seen: Float32Array) -> Float32Array:
        """Returns (4, 2) places after each half second, in the ego's frame, metres."""
        ...


class WaypointAgent:
    """The agent. One object drives one ego through one run."""

    def __init__(self, view: View, network: Network) -> None:
        """Makes the agent.

        Args:
            view: View that fills the inputs of the network.
            network: Network that returns waypoints.
        """
        self._view = view
        self._network = network

    def setup_env(self, context: AgentContext) -> None:
        """Resets the view, and lets the network decide in the first step."""
        self._view.setup_env(context)
        self._wheelbase = context.model.wheelbase
        self._max_braking = min(context.model.max_deceleration, 9.81 * context.friction)
        self._next_decision = -math.inf
        self._control = AccelerationControl(0.0, 0.0)
        self._log = context.log
        self._log.declare(*(f"waypoint_{k}_{axis}" for k in range(WAYPOINTS) for axis in "xy"))

    def run_step(self, observation: Observation) -> AccelerationControl:
        """Returns the control towards the network's waypoints, which are renewed when due."""
        self._view.follow(observation)
        if observation.time > self._next_decision - 1e-6:
            self._next_decision = observation.time + _PERIOD
            self._view.look(observation)
            waypoints = self._network.waypoints(self._view.seen)
            self._log.row[:] = waypoints.ravel()
            self._control = AccelerationControl(
                *drive_waypoints(
                    waypoints, max(observation.speed, 0.0), self._wheelbase, self._max_braking,
                    self._control.steer,
                )
            )  # fmt: skip
        return self._control
