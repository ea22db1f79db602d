"""A rule-based ADS: car following by the intelligent driver model, steering by pure pursuit.

It obeys traffic lights and the network's right of way, yields in conflict zones by gap acceptance,
keeps junctions clear, changes lanes where its route needs it, and never overtakes. Source of the
car-following model: Treiber, Hennecke, Helbing, *Congested traffic states in empirical observations
and microscopic simulations* (2000); of the steering: Coulter, *Implementation of the pure pursuit
path tracking algorithm* (1992).
"""

from __future__ import annotations

from drivora_service.agents.idm.driver import IdmDriver
from drivora_service.agents.idm.run_following import RunFollower
from drivora_service.agents.interface import AccelerationControl, AgentContext, Observation


class IdmAgent:
    """The agent. One object drives one ego through one run."""

    def __init__(self, speed_factor: float = 1.0) -> None:
        """Args: speed_factor: As in ``IdmParameters``."""
        self._speed_factor = speed_factor

    def setup_env(self, context: AgentContext) -> None:
        """Prepares speed profiles and conflict zones along the route."""
        self._runs = RunFollower(context, self._speed_factor)
        self._driver = IdmDriver(context)

    def run_step(self, observation: Observation) -> AccelerationControl:
        """Drives."""
        self._runs.wait(observation.speed)
        self._runs.change_when_possible(observation)
        return self._driver.drive(observation, self._runs)
