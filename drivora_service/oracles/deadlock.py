"""Deadlock: egos that wait for one another."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from shapely import LineString, Polygon

from drivora_service.geometry.angles import wrap_angle
from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import LEVEL_GAP, Col
from drivora_service.oracles.blocked import STANDING_SPEED, standing_clock
from drivora_service.oracles.verdict import (
    Severity,
    Verdict,
    not_applicable,
    not_started,
    passed,
    violated,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Deadlock:
    """Violated where two or more egos stand, each because of another of them, in a cycle.

    An ego waits for another that stands ahead of it: near its front, in sight, within the angle in
    which a driver looks for crossing traffic. A cycle cannot dissolve by waiting, so the duration
    is shorter than that of a block.

    Attributes:
        standing_speed: m/s below which an ego stands.
        duration: Seconds for which all of the cycle must have stood.
        reach: Metres from the middle of the front bumper to the nearest corner of the other.
        bearing: Radians to either side of the heading.
    """

    standing_speed: float = STANDING_SPEED
    duration: float = 10.0
    reach: float = 20.0
    bearing: float = float(np.radians(75.0))

    @property
    def name(self) -> str:
        """Name in the catalogue."""
        return "deadlock"

    def judge(self, run: RunView) -> tuple[Verdict, ...]:
        """Returns one verdict an ego."""
        clocks = [standing_clock(ego, self.standing_speed) for ego in run.egos]
        found = self._first_cycles(run, clocks)
        verdicts = []
        for ego in run.egos:
            if not ego.count:
                verdicts.append(not_started(self.name, ego))
            elif len(run.egos) < 2:
                message = "The run has no other ego to wait for."
                verdicts.append(not_applicable(self.name, ego, message))
            elif ego.row not in found:
                message = "No egos waited for one another."
                verdicts.append(passed(self.name, ego, message))
            else:
                step, cycle = found[ego.row]
                names = [run.egos[row].id for row in cycle]
                verdicts.append(
                    violated(
                        self.name,
                        ego,
                        step - ego.first,
                        f"Waits in a cycle: {' → '.join([*names, names[0]])}.",
                        counterpart=run.egos[_next(cycle, ego.row)].id,
                        cycle=names,
                        severity=Severity.MINOR,
                    )
                )
        return tuple(verdicts)

    def _first_cycles(
        self, run: RunView, clocks: Sequence[np.ndarray[tuple[int], np.dtype[np.float64]]]
    ) -> dict[int, tuple[int, tuple[int, ...]]]:
        """Returns (row of the trace, cycle) for every ego that is in one, at its first time."""
        found: dict[int, tuple[int, tuple[int, ...]]] = {}
        if len(run.egos) < 2:
            return found
        stuck = np.zeros((run.trace.step_count, len(run.egos)), dtype=np.bool_)
        for ego, clock in zip(run.egos, clocks, strict=True):
            stuck[ego.first : ego.first + ego.count, ego.row] = clock >= self.duration - 1e-9
        # An ego that stands keeps waiting for the same egos: search once for each set that stands.
        groups = np.flatnonzero(np.any(stuck[1:] & ~stuck[:-1], axis=1)) + 1
        for step in [0, *groups] if stuck[0].any() else groups:
            rows = np.flatnonzero(stuck[step])
            waits_for = {
                int(row): self._waits_for(run, int(step), int(row), rows.tolist()) for row in rows
            }
            for cycle in _cycles(waits_for):
                for row in cycle:
                    found.setdefault(row, (int(step), cycle))
        return found

    def _waits_for(self, run: RunView, step: int, row: int, candidates: list[int]) -> list[int]:
        ego = run.egos[row]
        k = step - ego.first
        x, y, yaw = ego.states[k, [Col.X, Col.Y, Col.YAW]]
        front_x = x + 0.5 * ego.actor.length * math.cos(yaw)
        front_y = y + 0.5 * ego.actor.length * math.sin(yaw)
        before = []
        for other_row in candidates:
            other = run.egos[other_row]
            height = other.states[step - other.first, Col.Z]
            if other_row == row or abs(height - ego.states[k, Col.Z]) > LEVEL_GAP:
                continue
            corners = other.corners[step - other.first]
            dx, dy = corners[:, 0] - front_x, corners[:, 1] - front_y
            nearest = int(np.argmin(np.hypot(dx, dy)))
            bearing = wrap_angle(float(math.atan2(dy[nearest], dx[nearest]) - yaw))
            near = np.hypot(dx[nearest], dy[nearest]) <= self.reach
            if near and abs(bearing) <= self.bearing:
                sight = LineString([(front_x, front_y), corners[nearest]])
                before.append((other_row, sight, Polygon(corners)))
        return [
            other_row
            for other_row, sight, _ in before
            if not any(sight.intersects(box) for third, _, box in before if third != other_row)
        ]


def _cycles(waits_for: dict[int, list[int]]) -> list[tuple[int, ...]]:
    """Returns a shortest cycle through every node that is in one, each cycle once."""
    cycles: list[tuple[int, ...]] = []
    for start in waits_for:
        if any(start in cycle for cycle in cycles):
            continue
        paths: list[tuple[int, ...]] = [(start,)]
        seen = {start}
        while paths:
            path = paths.pop(0)
            if start in waits_for[path[-1]]:
                cycles.append(path)
                break
            for node in waits_for[path[-1]]:
                if node not in seen:
                    seen.add(node)
                    paths.append((*path, node))
    return cycles


def _next(cycle: tuple[int, ...], row: int) -> int:
    return cycle[(cycle.index(row) + 1) % len(cycle)]
