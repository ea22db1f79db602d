"""Egos and actors that drive on shipped networks, for rules that look at the network."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from drivora_service.geometry.lines import arc_lengths
from drivora_service.networks.projection import project_points
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import Col
from drivora_service.oracles.verdict import Oracle, Verdict
from drivora_service.testing.traces import Motion, SyntheticActor, SyntheticEgo, make_trace

DT = 0.05


def way(network: RoadNetwork, *lanes: str) -> np.ndarray:
    """The (n, 2) line along lanes, one behind the other; lanes inside junctions are found."""
    points = [network.lane(lanes[0]).shape]
    for before, after in itertools.pairwise(lanes):
        points += [network.lane(lane).shape for lane in inside(network, before, after)]
        points.append(network.lane(after).shape)
    line = np.concatenate(points)
    return line[np.concatenate(([True], np.hypot(*np.diff(line, axis=0).T) > 0.01))]


def inside(network: RoadNetwork, before: str, after: str) -> list[str]:
    """The lanes inside the junction from one lane to another."""
    for connection in network.lane(before).connections:
        lanes, lane = [], network.lanes[connection.to_lane]
        while lane.is_internal:
            lanes.append(lane.id)
            lane = network.lanes[lane.connections[0].to_lane]
        if lane.edge_id == network.lane(after).edge_id:
            return lanes
    raise AssertionError(f"no way from {before} to {after}")


def along(line: np.ndarray, fronts: np.ndarray, *, length: float = 4.5) -> Motion:
    """A vehicle with its front at the given metres of a line, one value a step."""
    arc = arc_lengths(line)
    s = np.asarray(fronts) - 0.5 * length
    x, y = (np.interp(s, arc, line[:, k]) for k in (0, 1))
    ahead = [np.interp(np.minimum(s + 0.5, arc[-1]), arc, line[:, k]) for k in (0, 1)]
    behind = [np.interp(np.maximum(s - 0.5, 0.0), arc, line[:, k]) for k in (0, 1)]
    yaw = np.arctan2(ahead[1] - behind[1], ahead[0] - behind[0])
    motion = Motion.along(x, y, yaw=yaw)
    speed = np.gradient(np.asarray(fronts, dtype=np.float64), DT)
    motion.states[:, Col.VX], motion.states[:, Col.VY] = speed * np.cos(yaw), speed * np.sin(yaw)
    return motion


def on_network(network: RoadNetwork, motion: Motion, **fields: Any) -> SyntheticEgo:
    """An ego with the lanes that a run would have recorded."""
    places, yaw = motion.states[:, [Col.X, Col.Y]].copy(), motion.states[:, Col.YAW].copy()
    found = project_points(network, places, yaw)
    limits = np.array([lane.speed_limit for lane in network.lanes])
    return SyntheticEgo(
        **{
            "motion": motion,
            "lane": found.lane,
            "lane_lateral": np.where(found.lane >= 0, found.lateral, np.nan),
            "lane_heading": np.where(found.lane >= 0, found.heading, np.nan),
            "speed_limit": np.where(found.lane >= 0, limits[found.lane], np.nan),
            **fields,
        }
    )


def judge_on(
    network: RoadNetwork,
    oracle: Oracle,
    *egos: SyntheticEgo,
    others: Sequence[SyntheticActor] = (),
    lights: Mapping[str, Sequence[str]] | None = None,
) -> tuple[Verdict, ...]:
    trace = make_trace(egos, others, lights=lights, step_length=DT)
    return oracle.judge(RunView(trace, network))


def steady(speed: float, steps: int, start: float = 6.0) -> np.ndarray:
    """Metres of the front at a constant speed."""
    return start + speed * DT * np.arange(steps)
