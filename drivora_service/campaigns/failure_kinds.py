"""Which violations are the same kind of failure.

The key of a violation names the rule, where it was broken, and how the other actor stood to the ego
(after DoppelTest's type and routes): ``collision|junction C|vehicle, front``. Two violations with
the same key may still differ much; ``campaigns.grouping`` looks at their numbers.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from drivora_service.networks.projection import nearest_lane_position
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.oracles.verdict import Verdict

_SEPARATOR = "|"


@dataclass(frozen=True, slots=True)
class FailureKinds:
    """Returns keys of violations on one road network."""

    network: RoadNetwork

    def __call__(self, verdict: Verdict) -> str:
        """Returns the key of a violation."""
        parts = (verdict.oracle, self.place(verdict), relation(verdict.evidence))
        return _SEPARATOR.join(part for part in parts if part)

    def place(self, verdict: Verdict) -> str:
        """Names the junction or the road where a rule was broken; "" where that is not known."""
        if verdict.location is None:
            return ""
        x, y = verdict.location
        near = nearest_lane_position(self.network, x, y, max_distance=100.0)
        if near is None:
            return "off every road"
        lane = self.network.lanes[near.lane]
        if lane.is_internal:
            return f"junction {junction_of(lane.edge_id)}"
        return f"road {lane.edge_id}"


def junction_of(internal_edge_id: str) -> str:
    """Returns the junction of an internal edge: SUMO calls them ``:JUNCTION_NUMBER``."""
    return internal_edge_id.removeprefix(":").rpartition("_")[0]


def relation(evidence: Mapping[str, Any]) -> str:
    """Says how the other stood to the ego, as far as an oracle tells; else "".

    Of a collision that is who the other was and the part of the ego that was touched; of a
    deadlock, how many wait for one another.
    """
    cycle = evidence.get("cycle")
    if isinstance(cycle, list | tuple):
        return f"cycle of {len(cycle)}"
    told = (evidence.get("counterpart_role"), evidence.get("face"))
    return ", ".join(str(part) for part in told if part)
