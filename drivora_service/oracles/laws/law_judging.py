"""A traffic law as an oracle."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any
from weakref import WeakKeyDictionary, ref

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.observations.run_view import EgoView, RunView
from drivora_service.observations.stretches import stretches
from drivora_service.oracles.laws.formula import Formula
from drivora_service.oracles.laws.law import Law
from drivora_service.oracles.laws.law_signals import signal_values
from drivora_service.oracles.laws.robustness import LEAST, MOST, Robustness
from drivora_service.oracles.verdict import (
    Verdict,
    not_applicable,
    not_started,
    passed,
    violated,
)

MOST_POINTS = 60
"""Greatest number of points of a curve in a verdict."""

_PAUSE = 1.0
"""Seconds between violations below which they are one."""

_DECIMALS = 3

_KNOWN: WeakKeyDictionary[EgoView, dict[float, Robustness]] = WeakKeyDictionary()


@dataclass(frozen=True, slots=True, kw_only=True)
class LawOracle:
    """Violated where the robustness of a traffic law is negative.

    What happens before the ego's part and after its end is not known, and taken in its favour.
    There is nothing to judge if the condition of the law, A of ``always (A -> B)``, never held.
    """

    law: Law

    @property
    def name(self) -> str:
        """Name in the catalogue."""
        return self.law.name

    def judge(self, run: RunView) -> tuple[Verdict, ...]:
        """Returns a verdict for every violation of the law."""
        return tuple(verdict for ego in run.egos for verdict in self._judge(ego))

    def _judge(self, ego: EgoView) -> list[Verdict]:
        if not ego.count:
            return [not_started(self.name, ego)]
        robustness = _over(ego, beyond=MOST).of(self.law.formula)
        least = round(float(robustness.min()), _DECIMALS)
        violations = _merge_stretches(stretches(robustness < 0.0), ego.step_length)
        if not violations:
            # Law coverage and searches read these, whether there was something to judge or not.
            facts = {"robustness": least, "ways": len(self.law.sub_violations)}
            if not self._has_applied(ego):
                message = "The condition of the law never held."
                return [not_applicable(self.name, ego, message, **facts)]
            return [passed(self.name, ego, f"Kept (robustness {least:+.2f}).", **facts)]
        curve = _curve(ego, robustness)
        return [
            self._make_violation(ego, robustness, first, last, curve) for first, last in violations
        ]

    def _has_applied(self, ego: EgoView) -> bool:
        """Returns whether the condition of the law may have held in a row.

        What is not recorded may have been as the condition requires.
        """
        condition = self.law.condition
        return condition is None or float(_over(ego, beyond=MOST).of(condition).max()) > 0.0

    def _make_violation(
        self,
        ego: EgoView,
        robustness: FloatArray,
        first: int,
        last: int,
        curve: dict[str, Any],
    ) -> Verdict:
        worst = first + int(np.argmin(robustness[first:last]))
        least = float(robustness[worst])
        how = self._ways(_over(ego, beyond=LEAST), first, last)
        # Near an end of the record it may be known that the law is violated, but not how.
        perhaps = [] if how else self._ways(_over(ego, beyond=MOST), first, last)
        seconds = float(ego.times[last - 1] - ego.times[first])
        during = f"for {seconds:.1f} s" if last - first > 1 else "at one moment"
        return violated(
            self.name,
            ego,
            first,
            f"{self.law.title}: violated {during} (robustness {least:+.2f}).",
            severity=self.law.severity,
            at_fault=True,
            robustness=round(least, _DECIMALS),
            until=float(ego.times[last - 1]),
            worst_time=float(ego.times[worst]),
            sub_violations=how,
            possible_sub_violations=perhaps,
            ways=len(self.law.sub_violations),
            article=self.law.source,
            formula=self.law.text,
            **curve,
        )

    def _ways(self, over: Robustness, first: int, last: int) -> list[str]:
        """Returns the ways in which the law is violated in some rows."""
        return [
            str(case)
            for case in self.law.sub_violations
            if float(over.of(case)[first:last].max()) > 0.0
        ]


def law_robustness(ego: EgoView, law: Law) -> float:
    """Returns the least robustness of a law over an ego's part, which has rows.

    It is negative where the law is violated. What is not recorded counts in the ego's favour, as
    for the verdict.
    """
    return float(_over(ego, beyond=MOST).of(law.formula).min())


def violation_robustness(ego: EgoView, cases: Sequence[Formula]) -> tuple[float, ...]:
    """Returns the greatest robustness of each violation over an ego's part, which has rows.

    What is not recorded counts against the violation.
    """
    over = _over(ego, beyond=LEAST)
    return tuple(float(over.of(case).max()) for case in cases)


def _over(ego: EgoView, *, beyond: float) -> Robustness:
    """Returns what computes the robustness of all laws over an ego's part, with what it knows."""
    known = _KNOWN.setdefault(ego, {})
    if beyond not in known:
        # It must not keep the view alive, by which it is found.
        view = ref(ego)
        known[beyond] = Robustness(
            lambda name: _values(view, name), ego.step_length, ego.count, beyond=beyond
        )
    return known[beyond]


def _values(view: ref[EgoView], name: str) -> FloatArray:
    ego = view()
    assert ego is not None, "the caller holds the view"
    return signal_values(ego, name)


def _merge_stretches(found: list[tuple[int, int]], step_length: float) -> list[tuple[int, int]]:
    """Joins stretches with less than ``_PAUSE`` between them."""
    merged: list[tuple[int, int]] = []
    for first, last in found:
        if merged and (first - merged[-1][1]) * step_length < _PAUSE:
            merged[-1] = (merged[-1][0], last)
        else:
            merged.append((first, last))
    return merged


def _curve(ego: EgoView, robustness: FloatArray) -> dict[str, Any]:
    """Returns the robustness over time: of equal parts of the run, the least with its time."""
    parts = np.array_split(np.arange(ego.count), min(ego.count, MOST_POINTS))
    rows = [int(part[np.argmin(robustness[part])]) for part in parts]
    return {
        "curve_times": [round(float(ego.times[row]), _DECIMALS) for row in rows],
        "curve_robustness": [round(float(robustness[row]), _DECIMALS) for row in rows],
    }
