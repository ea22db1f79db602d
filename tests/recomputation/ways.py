"""Ways along the lanes of a town, for the documents of mixed runs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import shapely

from tests.recomputation.town import RoadLane, Town, lane_length

Random = np.random.Generator


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Way:
    """A way along lanes.

    Attributes:
        lanes: In order, those inside junctions included.
        line: Centre line, metres.
        ends: Metres along the line at which each lane ends.
    """

    lanes: tuple[RoadLane, ...]
    line: shapely.LineString
    ends: tuple[float, ...]

    def place(self, s: float, aside: float = 0.0) -> dict[str, float]:
        """Returns the place at ``s`` metres, so many metres to the left, with its heading."""
        here, ahead = (shapely.get_coordinates(self.line.interpolate(v))[0] for v in (s, s + 0.2))
        dx, dy = (ahead - here) / np.hypot(*(ahead - here))
        return {
            "x": float(here[0] - aside * dy),
            "y": float(here[1] + aside * dx),
            "yaw": float(np.degrees(np.arctan2(dy, dx))),
        }

    def waypoints(self, start: float, end: float) -> list[dict[str, float]]:
        """Returns a route along the way: start, a place on each lane, destination."""
        begins = (0.0, *self.ends[:-1])
        middles = [
            0.5 * (a + b)
            for lane, a, b in zip(self.lanes, begins, self.ends, strict=True)
            if not lane.inside and start + 15.0 < 0.5 * (a + b) < end - 15.0
        ]
        return [self.place(s) for s in (start, *middles, end)]

    def trajectory(
        self, start: float, speed: float, aside: Callable[[float], float] = lambda s: 0.0
    ) -> list[list[float]]:
        """Returns places of a script along the way: seconds, x and y in metres, every 2 m."""
        script = []
        for s in np.arange(start, self.line.length - 1.0, 2.0):
            at = self.place(float(s), aside(float(s) - start))
            script.append([float(s - start) / speed, at["x"], at["y"]])
        return script


def find_way(town: Town, random: Random, length: float, *starts: RoadLane) -> Way:
    """Returns a way that begins on one of the lanes, or on any, and ends on a road.

    Args:
        town: Where.
        random: Chooses.
        length: Metres that it has at least; it goes on behind its first lane in any case.
        starts: The lanes.
    """
    roads = [lane for lane in town.lanes.values() if not lane.inside and lane_length(lane) > 25.0]
    choice = starts or tuple(lane for lane in roads if lane.movements)
    for _ in range(200):
        lanes = [choice[random.integers(len(choice))]]
        wanted = max(length, lane_length(lanes[0]) + 60.0)
        while sum(map(lane_length, lanes)) < wanted or lanes[-1].inside:
            ahead = [m for m in lanes[-1].movements if m.to in town.lanes]
            if not ahead:
                break
            movement = ahead[random.integers(len(ahead))]
            following = town.lanes[movement.via or movement.to]
            if following in lanes:
                break
            lanes.append(following)
        else:
            line = np.concatenate([lane.line for lane in lanes])
            ends = np.cumsum([lane_length(lane) for lane in lanes])
            return Way(
                lanes=tuple(lanes),
                line=shapely.LineString(line[np.r_[True, np.any(np.diff(line, axis=0), axis=1)]]),
                ends=tuple(ends.tolist()),
            )
    raise LookupError(f"found no way of {length} m in {town.name}")
