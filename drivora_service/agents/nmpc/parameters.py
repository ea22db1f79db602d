"""Parameters of the agent that plans by optimisation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from drivora_service.agents.idm.parameters import SpeedFactor


@dataclass(frozen=True, slots=True, kw_only=True)
class NmpcParameters:
    """Parameters of the agent.

    Attributes:
        speed_factor: Share of the speed limit that it drives where the road is free.
        max_iterations: Of the solver, after which there is no plan.
    """

    speed_factor: SpeedFactor = 1.0
    max_iterations: Annotated[int, Field(ge=1, le=200)] = 40
