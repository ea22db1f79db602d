"""Parameters of the intelligent driver model."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

SpeedFactor = Annotated[float, Field(ge=0.1, le=2.0)]


@dataclass(frozen=True, slots=True, kw_only=True)
class IdmParameters:
    """Parameters of the agent.

    Attributes:
        speed_factor: Share of the speed limit that it drives where the road is free.
    """

    speed_factor: SpeedFactor = 1.0
