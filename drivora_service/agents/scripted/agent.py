"""The agent ``scripted``: an ego that follows its document's script, regardless of other actors."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np

from drivora_service.agents.interface import AgentContext, Control, Observation, PoseControl
from drivora_service.agents.scripted.parameters import ScriptedParameters
from drivora_service.errors import AgentError
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.observations.trace import Col

_STANDING_SPEED = 0.05
"""m/s below which the direction of motion does not determine the heading."""


class ScriptedAgent:
    """Follows its script at every step, as far as the vehicle's limits allow.

    Between two places it moves smoothly and without overshooting (a monotone cubic in each
    coordinate, Fritsch and Carlson 1980); its heading is the direction of motion.
    """

    def __init__(self, parameters: ScriptedParameters) -> None:
        """Checks the script.

        Raises:
            AgentError: If the trajectory has a single place, or its times do not ascend.
        """
        _check(parameters.trajectory)
        self._parameters = parameters
        self._times: FloatArray = np.zeros(0)
        self._places: FloatArray = np.zeros((0, 2))
        self._step_length = 0.05
        self._route_arc: FloatArray | None = None

    def setup_env(self, context: AgentContext) -> None:
        """Computes the curve through the places of the trajectory; without one, takes the route."""
        # Imported here, so that workers with other agents start without it.
        from scipy.interpolate import PchipInterpolator

        self._step_length = context.step_length
        if self._parameters.trajectory:
            script = np.array(self._parameters.trajectory)
            self._times, self._places = script[:, 0], script[:, 1:]
            self._route_arc = None
            self._curve = PchipInterpolator(self._times, self._places, axis=0)
        else:
            self._route_arc, self._places = context.route.arc, context.route.line

    def run_step(self, observation: Observation) -> Control:
        """Returns the pose of the script at the end of this step."""
        if self._route_arc is not None:
            return self._along_route(observation, self._route_arc)
        time = observation.time + self._step_length
        inside = min(max(time, float(self._times[0])), float(self._times[-1]))
        x, y = self._curve(inside).tolist()
        vx, vy = self._curve(inside, 1).tolist() if time == inside else (0.0, 0.0)
        speed = math.hypot(vx, vy)
        held = float(observation.ego[Col.YAW])
        yaw = math.atan2(vy, vx) if speed > _STANDING_SPEED else held
        return PoseControl(x=x, y=y, yaw=yaw, speed=speed)

    def _along_route(self, observation: Observation, arc: FloatArray) -> PoseControl:
        ahead = observation.route_s + self._parameters.speed * self._step_length
        # Beyond its end the route is extended straight.
        i = min(max(int(np.searchsorted(arc, ahead, side="right")) - 1, 0), len(arc) - 2)
        (x0, y0), (x1, y1) = self._places[i].tolist(), self._places[i + 1].tolist()
        share = (ahead - float(arc[i])) / float(arc[i + 1] - arc[i])
        x, y = x0 + share * (x1 - x0), y0 + share * (y1 - y0)
        return PoseControl(x=x, y=y, yaw=math.atan2(y1 - y0, x1 - x0), speed=self._parameters.speed)


def _check(trajectory: Sequence[tuple[float, float, float]]) -> None:
    if len(trajectory) == 1:
        raise AgentError(
            "agent 'scripted': trajectory has 1 place; allowed: none, or at least 2",
            cause="agent_parameters",
        )
    for (before, *_), (after, *_) in itertools.pairwise(trajectory):
        if after <= before:
            raise AgentError(
                f"agent 'scripted': the times of trajectory do not ascend ({before:g} s, then "
                f"{after:g} s); allowed: each later than the one before",
                cause="agent_parameters",
            )
