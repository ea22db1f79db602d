"""Egos that SUMO itself drives: baselines for comparison with ADSs."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

from drivora_service.errors import AgentError

LaneChangeModel = Literal["LC2013", "SL2015"]
"""SUMO's lane-change models for whole lanes, and for positions within and between lanes."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SumoDriverParameters:
    """Parameters of the agent.

    Attributes:
        lane_change_model: SL2015 needs SUMO's sublane simulation, in which all drivers
            of SUMO in that run change lanes by it.
    """

    lane_change_model: LaneChangeModel = "LC2013"


@dataclass(frozen=True, slots=True, kw_only=True)
class SumoDriver:
    """One of SUMO's drivers, instead of an agent.

    Attributes:
        car_following: First part of the ids of vehicle types in
            ``simulation/driver_types.add.xml``.
    """

    car_following: str
    lane_change_model: LaneChangeModel = "LC2013"

    @property
    def type_id(self) -> str:
        """The vehicle type: car-following model and lane-change model."""
        return f"{self.car_following}-{self.lane_change_model}"


def common_lane_change_model(agents: Iterable[object]) -> LaneChangeModel:
    """Returns the lane-change model of a run: SUMO has one for all its drivers.

    Args:
        agents: All agents of the run; those that are not SUMO's drivers are ignored.

    Raises:
        AgentError: If two of SUMO's drivers want different ones.
    """
    wanted = {agent.lane_change_model for agent in agents if isinstance(agent, SumoDriver)}
    if len(wanted) > 1:
        raise AgentError(
            "SUMO's drivers of two egos want different lane-change models, LC2013 and SL2015, of "
            "which SUMO has one in a run: set `lane_change_model` to the same for all",
            cause="agent_parameters",
        )
    return wanted.pop() if wanted else "LC2013"
