"""Parameters of the agent that follows a trajectory."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field


@dataclass(frozen=True, slots=True, kw_only=True)
class ScriptedParameters:
    """Parameters of the agent.

    Attributes:
        speed: m/s along the route, where there is no trajectory.
        trajectory: Places of the box centre: seconds of simulation, x and y in metres of the road
            network's plane. The ego stays at the last one. An empty list: along the route.
    """

    speed: Annotated[float, Field(ge=0.0, le=100.0)] = 8.0
    trajectory: tuple[tuple[float, float, float], ...] = ()
