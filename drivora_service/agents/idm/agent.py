"""A rule-based ADS: car following by the intelligent driver model, steering by pure pursuit.

It obeys traffic lights and the network's right of way, yields in conflict zones by gap acceptance,
keeps junctions clear, changes lanes where its route needs it, and never overtakes. Source of the
car-following model: Treiber, Hennecke, Helbing, *Congested traffic states in empirical observations
and microscopic simulations* (2000); of the steering: Coulter, *Implementation of the pure pursuit
path tracking algorithm* (1992).
"""

from __future__ import annotations

from drivora_service.agents.idm.driver import IdmDriver
from drivora_service.agents.idm.reaction import ReactionDelay
from drivora_service.agents.idm.run_following import RunFollower
from drivora_service.agents.interface import AccelerationControl, AgentContext, Observation


class IdmAgent:
    """The agent. One object drives one ego through one run."""

    def __init__(self, speed_factor: float = 1.0, reaction_time: float = 0.0) -> None:
        """Args: as in ``IdmParameters``."""
        self._speed_factor = speed_factor
        self._reaction_time = reaction_time

    def setup_env(self, context: AgentContext) -> None:
        """Computes speed profiles and conflict zones along the route."""
        self._runs = RunFollower(context, self._speed_factor)
        self._driver = IdmDriver(context)
        self._delayed = (
            ReactionDelay(self._reaction_time, context.step_length, 0.5 * context.model.length)
            if self._reaction_time > 0.0
            else None
        )

    def run_step(self, observation: Observation) -> AccelerationControl:
        """Returns the control of a step: that of the present lane run, or of the next one."""
        seen = observation if self._delayed is None else self._delayed(observation)
        self._runs.wait(seen.speed)
        self._runs.change_when_possible(seen)
        return self._driver.drive(seen, self._runs)
