"""The ADSs that drive every scenario: a scenario's difficulty is how many of them fail in it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True, kw_only=True)
class Driver:
    """An ADS with its parameters.

    Attributes:
        label: Names it among the others.
        agent: Name of the ADS.
    """

    label: str
    agent: str
    parameters: tuple[tuple[str, float], ...] = ()

    def as_agent(self) -> dict[str, Any]:
        """Returns the ADS as a study names it."""
        return {"name": self.agent, "label": self.label, "parameters": dict(self.parameters)}


def _plain(name: str) -> Driver:
    return Driver(label=name, agent=name)


SLOW = Driver(label="idm-slow", agent="idm", parameters=(("reaction_time", 1.0),))
"""A version of ``idm`` that is worse: failures were searched for against it, too, since a suite
that tells no two versions apart is of no use."""

_IDM = Driver(label="idm", agent="idm", parameters=(("reaction_time", 0.0),))
"""With the default, since an ego of this ADS keeps the parameters that its scenario names."""

PANEL = (
    _IDM,
    *map(_plain, ("idm-mobil", "pdm-closed", "plant-lite", "ad-mlp")),
    *map(_plain, ("sumo-krauss", "sumo-eidm", "sumo-acc")),
    SLOW,
)
