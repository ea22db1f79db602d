"""Comparison of the scores of Bench2Drive and nuPlan with a recomputation.

The verdicts of oracles are their events. Those that are compared by themselves elsewhere are
computed again here; the others (blocked, nuPlan's fault, stays outside the lanes) are taken as they
are.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property

import numpy as np

from tests.recomputation.comparing import (
    BORDER,
    OFF_ROAD,
    Comparison,
    Disagreement,
    Recomputed,
)
from tests.recomputation.foresight import meets_soon
from tests.recomputation.free_drive import compared_progress
from tests.recomputation.nuplan import direction, no_collision, speed_limit, whole_score
from tests.recomputation.recording import Flags
from tests.recomputation.routes import arrived, traffic_pace
from tests.recomputation.scores import charged
from tests.recomputation.smoothness import rough_rows, smooth_share

NUPLAN = (
    "no_at_fault_collision",
    "drivable_area",
    "driving_direction",
    "making_progress",
    "progress_to_free_flow",
    "time_to_collision",
    "speed_limit",
    "comfort",
)

CLOSE = 1e-6


class ScoreComparison(Comparison):
    """A run: its scores as stored, and computed again."""

    @cached_property
    def rough(self) -> list[Flags | None]:
        """For each ego the rows in which a signal of its motion is out of its bounds."""
        return [rough_rows(ego.drive, self.run.step_length) for ego in self.egos]

    def _compare(
        self, ego: Recomputed, name: str, own: float | None, spread: float = CLOSE
    ) -> Iterator[Disagreement]:
        stored = self._metric(name, ego)
        same = stored is own if own is None else stored is not None and abs(stored - own) <= spread
        if not same:
            yield self._differ(ego, name, stored, own)

    def bench2drive(self) -> Iterator[Disagreement]:
        """Compares success, efficiency and comfort."""
        for ego, rough in zip(self.egos, self.rough, strict=True):
            yield from self._compare(ego, "success", self.succeeded(ego))
            paces = traffic_pace(self.run, ego.drive, ego.progress, 20)
            usual = [100.0 * pace for pace in paces if pace <= 10.0]
            yield from self._compare(ego, "efficiency", float(np.mean(usual)) if usual else None)
            yield from self._compare(ego, "comfort", None if rough is None else smooth_share(rough))

    def succeeded(self, ego: Recomputed) -> float:
        """Returns whether an ego arrived without an infraction."""
        infractions = len(charged(self.run, ego.drive, ego.collisions)) + ego.reds + ego.deviated
        infractions += sum(stop.ran is True for stop in ego.stops)
        for oracle in ("blocked", "lane_keeping"):
            infractions += len(self._violations(oracle, ego))
        return float(arrived(self.run, ego.drive, ego.progress) and not infractions)

    def progress_bounds(self, ego: Recomputed) -> tuple[float, float]:
        """Returns the least and the greatest progress compared with a free drive."""
        friction = float(self.run.head["meta"].get("friction", 1.0))
        return compared_progress(ego.town, ego.drive, ego.progress, self.run.step_length, friction)

    def parts(self, ego: Recomputed) -> dict[str, tuple[float | None, float | None]]:
        """Returns the least and the greatest value of each part of nuPlan's score."""
        run, drive = self.run, ego.drive
        at_fault = [
            verdict.counterpart
            for verdict in self._violations("collision", ego)
            if verdict.evidence["nuplan_at_fault"]
        ]
        low, high = self.progress_bounds(ego)
        rough = self.rough[self.egos.index(ego)]
        soon = bool(at_fault) or meets_soon(run, drive, ego.collisions)
        furthest = float(ego.outside.max(initial=0.0))
        one = {
            "no_at_fault_collision": no_collision(run, at_fault),
            "driving_direction": direction(run, drive),
            "time_to_collision": float(not soon),
            "speed_limit": speed_limit(run, drive),
            "comfort": None if rough is None else float(not rough.any()),
        }
        return {
            **{name: (value, value) for name, value in one.items()},
            "drivable_area": (
                float(furthest <= OFF_ROAD - BORDER),
                float(furthest <= OFF_ROAD + BORDER),
            ),
            "progress_to_free_flow": (low, high),
            "making_progress": (float(low >= 0.2), float(high >= 0.2)),
        }

    def nuplan(self) -> Iterator[Disagreement]:
        """Compares the score and its parts.

        Where a route may be on several lanes with different limits, in junctions, the progress may
        be anywhere between the answers for the lowest and the highest.
        """
        for ego in self.egos:
            if not ego.drive.count:
                continue
            parts = self.parts(ego)
            for name in NUPLAN:
                low, high = parts[name]
                stored = self._metric(f"nuplan_{name}", ego)
                if low is None or high is None:
                    if stored is not low:
                        yield self._differ(ego, name, stored, low)
                elif stored is None or not low - CLOSE <= stored <= high + CLOSE:
                    yield self._differ(ego, name, stored, (low, high))
            # Parts that have a range as they are stored, so that the whole is compared exactly.
            told = {name: parts[name][0] for name in NUPLAN}
            for name in ("progress_to_free_flow", "making_progress", "drivable_area"):
                told[name] = self._metric(f"nuplan_{name}", ego)
            yield from self._compare(ego, "nuplan_closed_loop", whole_score(told), 1e-9)
