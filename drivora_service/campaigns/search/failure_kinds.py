"""The kinds of failures.

The kind of a violation names the oracle, the place, and the relation of the other actor to the ego
(after DoppelTest's type and routes): ``collision|junction C|vehicle, front``. Two violations of one
kind may still differ much; ``campaigns.search.failure_grouping`` compares their numbers.
"""

from __future__ import annotations

from dataclasses import dataclass

from drivora_service.networks.projection import nearest_lane_position
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.oracles.verdict import Verdict
from drivora_service.oracles.verdicts.failure_facts import relation

_SEPARATOR = "|"


@dataclass(frozen=True, slots=True)
class FailureKinds:
    """Determines the kinds of violations on one road network."""

    network: RoadNetwork

    def __call__(self, verdict: Verdict) -> str:
        """Returns the kind of a violation."""
        parts = (verdict.oracle, self.place(verdict), relation(verdict.evidence))
        return _SEPARATOR.join(part for part in parts if part)

    def place(self, verdict: Verdict) -> str:
        """Returns the name of a violation's junction or road; "" if it is not known."""
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
