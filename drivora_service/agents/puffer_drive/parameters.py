"""Parameters of the agent with PufferLib's policy."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

GOAL_DISTANCE = 20.0
"""Default distance of goals along the route, metres."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PufferDriveParameters:
    """Parameters of the agent.

    Attributes:
        goal_distance: Metres along the route from one goal to the next.
    """

    goal_distance: Annotated[float, Field(ge=5.0, le=100.0)] = GOAL_DISTANCE
