"""Comparison of a run's report with a recomputation from its trace."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from tests.recomputation.boxes import collisions
from tests.recomputation.recording import Drive, Flags, Recording, read_recording
from tests.recomputation.routes import Progress, deviation_row, follow_route, route_completion
from tests.recomputation.scores import penalties
from tests.recomputation.signals import Passed, lines_passed
from tests.recomputation.speeds import limits, speeding, stretches
from tests.recomputation.stops import StopPassed, stops_passed
from tests.recomputation.surfaces import corners_outside, lane_errors

OFF_ROAD = 0.3
"""Metres that a corner may be outside."""

OFF_ROAD_TIME, FAR_OFF_ROAD = 0.3, 0.5
"""Seconds that an excess must last, and metres from which on it counts however short."""

LANE_MARGIN = 0.5
"""Metres beyond the lanes that count as within."""

BORDER = 0.05
"""Metres by which the border of the drivable area may differ: the product draws the outside of
bends with four pieces a quarter, and moves centre lines by up to a centimetre."""


class Verdict(Protocol):
    """The compared parts of a stored verdict."""

    @property
    def oracle(self) -> str: ...
    @property
    def ego(self) -> str: ...
    @property
    def outcome(self) -> str: ...
    @property
    def step(self) -> int | None: ...
    @property
    def counterpart(self) -> str: ...
    @property
    def evidence(self) -> Mapping[str, Any]: ...


class Report(Protocol):
    """The compared parts of a run's report."""

    @property
    def run_id(self) -> str: ...
    @property
    def verdicts(self) -> Sequence[Verdict]: ...
    @property
    def metrics(self) -> Mapping[str, float | None]: ...


@dataclass(frozen=True, slots=True, kw_only=True)
class Disagreement:
    """Two answers to one question."""

    run: str
    ego: str
    rule: str
    stored: object
    recomputed: object


class Recomputed:
    """An ego of a run, computed again."""

    def __init__(self, run: Recording, drive: Drive) -> None:
        self.run, self.drive = run, drive
        self.town: str = run.head["network"]

    @cached_property
    def progress(self) -> Progress:
        """On its route."""
        return follow_route(self.drive)

    @cached_property
    def collisions(self) -> dict[str, int]:
        """Step of the first overlap with each other actor."""
        return collisions(self.run, self.drive)

    @cached_property
    def lines(self) -> list[Passed]:
        """Stop lines with a signal that it passed."""
        return lines_passed(self.run, self.drive, self.progress)

    @cached_property
    def speeding(self) -> list[tuple[int, float]]:
        """Step and seconds of each violation."""
        return speeding(self.town, self.drive, self.run.step_length)

    @cached_property
    def outside(self) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
        """(n,) metres by which the furthest corner is outside the drivable area."""
        return corners_outside(self.town, self.drive)

    @property
    def reds(self) -> int:
        """Red lights run."""
        return sum(line.red is True for line in self.lines)

    @cached_property
    def completion(self) -> float:
        """Per cent of the route."""
        return route_completion(self.run, self.drive, self.progress)

    @cached_property
    def stops(self) -> list[StopPassed]:
        """Lines at which it had to stop."""
        return stops_passed(self.run, self.drive)

    def scores(self, margin: float = LANE_MARGIN) -> dict[str, float]:
        """Returns the driving score by version, per cent.

        Args:
            margin: Metres beyond the lanes that count as within.
        """
        ran = sum(stop.ran is True for stop in self.stops)
        found = penalties(
            self.run, self.drive, self.progress, self.collisions, self.reds, ran, margin
        )
        return {version: self.completion * penalty for version, penalty in found.items()}

    @cached_property
    def deviated(self) -> bool:
        """Whether it left its route."""
        return deviation_row(self.drive, self.progress) is not None


class Comparison:
    """A run: what is stored of it, and what is computed again."""

    def __init__(self, report: Report, trace: Path) -> None:
        self.report = report
        self.run = read_recording(trace)
        self.egos = [Recomputed(self.run, drive) for drive in self.run.drives]

    def _verdicts(self, oracle: str, ego: Recomputed, *outcomes: str) -> list[Verdict]:
        return [
            verdict
            for verdict in self.report.verdicts
            if (verdict.oracle, verdict.ego) == (oracle, ego.drive.id)
            and verdict.outcome in outcomes
        ]

    def _violations(self, oracle: str, ego: Recomputed) -> list[Verdict]:
        return self._verdicts(oracle, ego, "violated")

    def _differ(self, ego: Recomputed, rule: str, stored: object, own: object) -> Disagreement:
        return Disagreement(
            run=self.report.run_id, ego=ego.drive.id, rule=rule, stored=stored, recomputed=own
        )

    def _metric(self, name: str, ego: Recomputed) -> float | None:
        key = name if len(self.egos) == 1 else f"{name}[{ego.drive.id}]"
        return self.report.metrics[key]

    def lanes(self) -> Iterator[Disagreement]:
        """Compares the lane and the speed limit in every row with the network's."""
        for ego in self.egos:
            wrong = lane_errors(ego.town, ego.drive) > BORDER
            if wrong.any():
                k = int(np.argmax(wrong))
                yield self._differ(
                    ego, f"lane at row {k}", ego.drive.lanes[k], (ego.drive.x[k], ego.drive.y[k])
                )
            stored, own = ego.drive.speed_limit, limits(ego.town, ego.drive)
            if not np.array_equal(stored, own, equal_nan=True):
                yield self._differ(ego, "speed limit", stored, own)

    def collisions(self) -> Iterator[Disagreement]:
        """Compares the actors that were hit, and the steps."""
        for ego in self.egos:
            stored = {v.counterpart: v.step for v in self._violations("collision", ego)}
            if stored != ego.collisions:
                yield self._differ(ego, "collision", stored, ego.collisions)

    def off_road(self) -> Iterator[Disagreement]:
        """Compares the rows off the road.

        At the very edge of what is allowed, a row may be either: those off the road with a wider
        border must be among the stored ones, and these among those with a narrower one.
        """
        for ego in self.egos:
            stored = self._violations("off_road", ego)
            said = np.zeros(ego.drive.count, dtype=np.bool_)
            for verdict in stored:
                first = (verdict.step or 0) - ego.drive.first
                rows = round(verdict.evidence["duration"] / self.run.step_length)
                said[first : first + rows] = True
            surely, perhaps = self.rows_off_road(ego, BORDER), self.rows_off_road(ego, -BORDER)
            if np.any(surely & ~said) or np.any(said & ~perhaps):
                yield self._differ(ego, "off_road", stretches(said), stretches(surely))
            furthest = max((v.evidence["distance"] for v in stored), default=0.0)
            own_furthest = float(ego.outside.max(initial=0.0))
            if stored and abs(furthest - own_furthest) > BORDER:
                yield self._differ(ego, "distance off the road", furthest, own_furthest)

    def rows_off_road(self, ego: Recomputed, border: float) -> Flags:
        """Returns the (n,) flags of rows off the road, by bounds that are ``border`` wider."""
        found = np.zeros(ego.drive.count, dtype=np.bool_)
        for first, last in stretches(ego.outside > OFF_ROAD + border):
            seconds = (last + 1 - first) * self.run.step_length
            deepest = float(ego.outside[first : last + 1].max())
            if seconds > OFF_ROAD_TIME - 1e-6 or deepest >= FAR_OFF_ROAD + border:
                found[first : last + 1] = True
        return found

    def speeding(self) -> Iterator[Disagreement]:
        """Compares beginning and duration of every violation."""
        for ego in self.egos:
            stored = [
                (v.step, round(v.evidence["duration"], 6))
                for v in self._violations("speeding", ego)
            ]
            own = [(step, round(seconds, 6)) for step, seconds in ego.speeding]
            if stored != own:
                yield self._differ(ego, "speeding", stored, own)

    def red_lights(self) -> Iterator[Disagreement]:
        """Compares the steps at which stop lines were crossed on red, or how many were crossed."""
        for ego in self.egos:
            stored = [v.step for v in self._violations("red_light", ego)]
            own = [line.step for line in ego.lines if line.red]
            if stored != own:
                yield self._differ(ego, "red_light", stored, (own, ego.lines))
            for verdict in self._verdicts("red_light", ego, "passed", "not_applicable"):
                if verdict.evidence.get("lines") != len(ego.lines):
                    yield self._differ(ego, "stop lines", verdict.evidence, ego.lines)

    def stop_signs(self) -> Iterator[Disagreement]:
        """Compares the steps at which stop signs were run, or how many were passed."""
        for ego in self.egos:
            stored = [v.step for v in self._violations("stop_sign", ego)]
            if stored != [stop.step for stop in ego.stops if stop.ran]:
                yield self._differ(ego, "stop_sign", stored, ego.stops)
            for verdict in self._verdicts("stop_sign", ego, "passed", "not_applicable"):
                if verdict.evidence.get("lines") != len(ego.stops):
                    yield self._differ(ego, "stop signs", verdict.evidence, ego.stops)

    def completion(self) -> Iterator[Disagreement]:
        """Compares the route completion."""
        for ego in self.egos:
            stored = self._metric("route_completion", ego)
            if stored is None or abs(stored - ego.completion) > 1e-6:
                yield self._differ(ego, "route_completion", stored, ego.completion)

    def scores(self) -> Iterator[Disagreement]:
        """Compares the driving scores of all versions.

        Where the centre is at the very edge of what counts as within the lanes, it may be either.
        """
        for ego in self.egos:
            low, high = ego.scores(LANE_MARGIN - BORDER), ego.scores(LANE_MARGIN + BORDER)
            for version, own in ego.scores().items():
                name = "driving_score" if version == "2_1" else f"driving_score_{version}"
                stored = self._metric(name, ego)
                if stored is None or not low[version] - 1e-6 <= stored <= high[version] + 1e-6:
                    yield self._differ(ego, name, stored, own)
