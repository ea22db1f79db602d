"""Parameters of the agent that drives the best of its proposals."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from drivora_service.agents.idm.parameters import SpeedFactor


@dataclass(frozen=True, slots=True, kw_only=True)
class PdmParameters:
    """Parameters of the agent.

    Attributes:
        speed_factor: Share of the speed limit that the fastest proposal drives at.
        offset: Metres beside the lane's centre at which proposals to either side drive; less where
            the road is narrower.
        brake_within: Seconds to a collision below which it brakes hard if no proposal avoids it.
        emergency_braking: How hard it brakes then, m/s².
    """

    speed_factor: SpeedFactor = 1.0
    offset: Annotated[float, Field(ge=0.2, le=2.0)] = 1.0
    brake_within: Annotated[float, Field(ge=0.0, le=4.0)] = 2.0
    emergency_braking: Annotated[float, Field(ge=2.0, le=9.0)] = 6.0
