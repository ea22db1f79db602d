"""The built-in oracles, and judging a run by several."""

from __future__ import annotations

from collections.abc import Sequence

from drivora_service.networks.road_network import RoadNetwork
from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import Trace
from drivora_service.oracles.blocked import Blocked
from drivora_service.oracles.collision import Collision
from drivora_service.oracles.deadlock import Deadlock
from drivora_service.oracles.destination import Destination
from drivora_service.oracles.discomfort import Discomfort
from drivora_service.oracles.failure_to_yield import FailureToYield
from drivora_service.oracles.junction_blocking import JunctionBlocking
from drivora_service.oracles.lane_keeping import LaneKeeping
from drivora_service.oracles.minimum_speed import MinimumSpeed
from drivora_service.oracles.near_miss import NearMiss
from drivora_service.oracles.non_optimal_decision import NonOptimalDecision
from drivora_service.oracles.off_road import OffRoad
from drivora_service.oracles.red_light import RedLight
from drivora_service.oracles.route_deviation import RouteDeviation
from drivora_service.oracles.speeding import Speeding
from drivora_service.oracles.stop_sign import StopSign
from drivora_service.oracles.tailgating import Tailgating
from drivora_service.oracles.verdict import ConditionalOracle, Oracle, Verdict
from drivora_service.oracles.verdicts.consequences import fold_consequences
from drivora_service.oracles.wrong_way import WrongWay


def default_oracles() -> tuple[Oracle, ...]:
    """Returns the built-in oracles with their default thresholds."""
    return (
        Collision(),
        RedLight(),
        StopSign(),
        FailureToYield(),
        OffRoad(),
        WrongWay(),
        LaneKeeping(),
        RouteDeviation(),
        Speeding(),
        Blocked(),
        JunctionBlocking(),
        Deadlock(),
        Destination(),
        NearMiss(),
        Tailgating(),
        MinimumSpeed(),
        Discomfort(),
        NonOptimalDecision(),
    )


def judge_all(
    trace: Trace,
    network: RoadNetwork,
    oracles: Sequence[Oracle],
    *,
    view: RunView | None = None,
) -> tuple[Verdict, ...]:
    """Judges a run by several oracles, without those that do not apply to it.

    Violations that only follow from another one name it (``follows``).

    Args:
        trace: The run.
        network: The road network it took place on.
        oracles: The oracles, in the order of their verdicts.
        view: An existing view of that run, whose computed values are reused.
    """
    view = view or RunView(trace, network)
    verdicts = [
        verdict
        for oracle in oracles
        if not isinstance(oracle, ConditionalOracle) or oracle.applies(view)
        for verdict in oracle.judge(view)
    ]
    ends = {ego.id: float(ego.times[-1]) for ego in view.egos if ego.count}
    return fold_consequences(verdicts, ends)
