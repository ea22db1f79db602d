"""How severe a violation is: the evidence that measures it, and how much is clearly more.

This module has the measures of all oracles. An oracle of a package can give its own as evidence,
see ``DECLARED``.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from drivora_service.oracles.verdict import Severity, Verdict
from drivora_service.shapes import Shape

RELATIVE_MARGIN = 0.25
"""Share of the earlier value by which a value must be worse, besides the measure's own margin."""

DECLARED = "violation_magnitude"
"""Evidence by which an oracle of a package gives a measure of its own: a mapping with ``name``,
``value`` and ``margin``, and perhaps ``unit`` and ``less_is_worse``."""

SEVERITY_CLASS = "severity_class"
"""Name of the severity of a verdict as a measure: 0 for observations to 3 for critical."""

_CLASSES = tuple(reversed(Severity))
_DECIMALS = 3
_BOUND_SHARE = 0.05
"""Share of a metric's bound by which a value beyond it must be worse."""

_LONGEST_LAG = 10.0
"""Seconds of encroachment that stand for any longer ones, and for an other that never came."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Magnitude(Shape):
    """How severe a violation is by one measure, in one run or in several.

    Attributes:
        name: Name of the measure, in snake case.
        unit: SI unit; empty if it has none or it is unknown.
        margin: Difference from which on one value is clearly worse than another one, if it is also
            a quarter of the earlier value.
        less_is_worse: Whether the smaller of two values is the more severe one.
        values: Its value in each run.
    """

    name: str
    unit: str = ""
    margin: float
    less_is_worse: bool = False
    values: tuple[float, ...]

    @property
    def words(self) -> str:
        """The name in words."""
        return self.name.replace("_", " ")

    @property
    def median(self) -> float:
        """The median of the values; of an even number, the less severe of the middle two."""
        return self._ordered[(len(self.values) - 1) // 2]

    @property
    def least(self) -> float:
        """The least severe value."""
        return self._ordered[0]

    @property
    def worst(self) -> float:
        """The most severe value."""
        return self._ordered[-1]

    @property
    def _ordered(self) -> list[float]:
        return sorted(self.values, reverse=self.less_is_worse)

    def is_clearly_worse(self, before: float, now: float) -> bool:
        """Returns whether a value is clearly worse: by the margin, and by a quarter of the other.

        Args:
            before: The earlier value.
            now: The later value.
        """
        growth = before - now if self.less_is_worse else now - before
        # Values are rounded: a difference of exactly the margin is not to depend on the last bit.
        slack = 1e-9
        return growth > slack and growth >= max(self.margin, RELATIVE_MARGIN * abs(before)) - slack

    def format(self, value: float) -> str:
        """Returns a value in words, without its unit."""
        if self.name == SEVERITY_CLASS:
            return _CLASSES[round(min(max(value, 0.0), len(_CLASSES) - 1.0))]
        return f"{value:.2f}" if self.margin < 0.5 else f"{value:.1f}"


@dataclass(frozen=True, slots=True, kw_only=True)
class _Measure:
    """A measure of the violations of an oracle.

    Attributes:
        of: Its value by the evidence; ``None`` where the evidence does not have it.
    """

    name: str
    unit: str
    margin: float
    of: Callable[[Mapping[str, Any]], float | None]
    less_is_worse: bool = False


def _given(name: str) -> Callable[[Mapping[str, Any]], float | None]:
    return lambda evidence: _number(evidence.get(name))


def _excess(high: str, low: str) -> Callable[[Mapping[str, Any]], float | None]:
    """Returns what computes the difference of two values of the evidence."""

    def difference(evidence: Mapping[str, Any]) -> float | None:
        more, less = _number(evidence.get(high)), _number(evidence.get(low))
        return None if more is None or less is None else more - less

    return difference


def _seconds_of(measure: str) -> Callable[[Mapping[str, Any]], float | None]:
    """Returns what reads the seconds of a near miss, if it was found by a measure."""
    return lambda evidence: (
        _number(evidence.get("seconds")) if evidence.get("measure") == measure else None
    )


def _lag(evidence: Mapping[str, Any]) -> float | None:
    """Returns the encroachment; the oracle gives none if the other came much later or never."""
    if "encroachment" not in evidence:
        return None
    lag = _number(evidence["encroachment"])
    return _LONGEST_LAG if lag is None else min(lag, _LONGEST_LAG)


_DURATION = _Measure(name="duration", unit="s", margin=1.0, of=_given("duration"))

_MEASURES: Mapping[str, tuple[_Measure, ...]] = {
    "collision": (
        _Measure(name="impact_speed", unit="m/s", margin=2.0, of=_given("relative_speed")),
    ),
    "red_light": (
        _Measure(name="speed", unit="m/s", margin=2.0, of=_given("speed")),
        _Measure(name="red_for", unit="s", margin=2.0, of=_given("red_for")),
    ),
    "stop_sign": (_Measure(name="slowest_approach", unit="m/s", margin=1.0, of=_given("slowest")),),
    "failure_to_yield": (
        _Measure(name="encroachment", unit="s", margin=0.4, of=_lag, less_is_worse=True),
        _Measure(name="braking", unit="m/s²", margin=1.0, of=_given("braking")),
    ),
    "off_road": (
        _Measure(name="depth", unit="m", margin=0.1, of=_given("distance")),
        _DURATION,
    ),
    "wrong_way": (_Measure(name="distance", unit="m", margin=1.0, of=_given("distance")),),
    "lane_keeping": (_Measure(name="distance", unit="m", margin=2.0, of=_given("distance")),),
    "route_deviation": (_Measure(name="distance", unit="m", margin=2.0, of=_given("distance")),),
    "speeding": (
        _Measure(name="excess", unit="m/s", margin=1.0, of=_excess("speed", "speed_limit")),
        replace(_DURATION, margin=2.0),
    ),
    "blocked": (replace(_DURATION, margin=10.0),),
    "junction_blocking": (
        replace(_DURATION, margin=5.0),
        _Measure(name="longest_wait", unit="s", margin=5.0, of=_given("longest_wait")),
    ),
    "destination": (
        _Measure(name="distance_left", unit="m", margin=10.0, of=_given("goal_distance")),
    ),
    "near_miss": tuple(
        _Measure(name=name, unit="s", margin=0.3, of=_seconds_of(name), less_is_worse=True)
        for name in ("time_to_collision", "post_encroachment_time")
    ),
    "tailgating": (
        _Measure(
            name="missing_distance", unit="m", margin=2.0, of=_excess("safe_distance", "distance")
        ),
        replace(_DURATION, margin=2.0),
    ),
    "minimum_speed": (
        _Measure(name="missing_speed", unit="m/s", margin=1.0, of=_excess("speed_limit", "speed")),
        replace(_DURATION, margin=5.0),
    ),
    "discomfort": (_Measure(name="share", unit="1", margin=0.1, of=_given("share")),),
    "non_optimal_decision": (
        _Measure(name="path_difference", unit="m", margin=1.0, of=_given("path_difference")),
    ),
}
"""The measures of the built-in oracles; a deadlock has none."""

_LAW = _Measure(
    name="robustness", unit="1", margin=0.1, of=_given("robustness"), less_is_worse=True
)
"""The measure of traffic laws, whose verdicts have a formula."""


def magnitudes_of(verdict: Verdict) -> tuple[Magnitude, ...]:
    """Returns how severe a violation is by each measure of its oracle, with one value each."""
    evidence = verdict.evidence
    measures = (_LAW,) if "formula" in evidence else _MEASURES.get(verdict.oracle, ())
    found = [
        Magnitude(
            name=one.name,
            unit=one.unit,
            margin=one.margin,
            less_is_worse=one.less_is_worse,
            values=(round(value, _DECIMALS),),
        )
        for one in measures
        if (value := one.of(evidence)) is not None
    ]
    declared = None if measures else declared_magnitude(evidence)
    return (*found, *(() if declared is None else (declared,)))


def declared_magnitude(evidence: Mapping[str, Any]) -> Magnitude | None:
    """Returns the measure that an oracle of a package gives; ``None`` without a valid one."""
    given = evidence.get(DECLARED)
    if not isinstance(given, Mapping):
        return None
    name, unit, less = given.get("name"), given.get("unit", ""), given.get("less_is_worse", False)
    value, margin = _number(given.get("value")), _number(given.get("margin"))
    is_named = isinstance(name, str) and bool(name) and isinstance(unit, str)
    if not is_named or not isinstance(less, bool) or value is None or not margin or margin < 0.0:
        return None
    return Magnitude(
        name=str(name),
        unit=str(unit),
        margin=margin,
        less_is_worse=less,
        values=(round(value, _DECIMALS),),
    )


def beyond_bound(value: float, *, low: float | None, high: float | None) -> Magnitude:
    """Returns how severe it is that a metric is outside its expected values.

    Args:
        value: The value.
        low: Smallest expected value, if there is one.
        high: Greatest expected value, if there is one.
    """
    bound = low if low is not None and value < low else high
    assert bound is not None, "the value is outside its bounds"
    return Magnitude(
        name="value_beyond_its_bound",
        margin=_BOUND_SHARE * abs(bound),
        values=(round(abs(value - bound), 6),),
    )


def class_magnitude(severities: Iterable[Severity]) -> Magnitude:
    """Returns the severities of violations as a measure: a graver one is clearly worse."""
    ranks = tuple(float(_CLASSES.index(one)) for one in severities)
    return Magnitude(name=SEVERITY_CLASS, margin=1.0, values=ranks)


def join_in_run(one: tuple[Magnitude, ...], two: tuple[Magnitude, ...]) -> tuple[Magnitude, ...]:
    """Returns the magnitudes of two violations of the same run: of each measure the worse value."""
    joined = {magnitude.name: magnitude for magnitude in one}
    for magnitude in two:
        before = joined.setdefault(magnitude.name, magnitude)
        both = replace(before, values=(*before.values, *magnitude.values))
        joined[magnitude.name] = replace(before, values=(both.worst,))
    return tuple(joined.values())


def add_run(runs: tuple[Magnitude, ...], further: tuple[Magnitude, ...]) -> tuple[Magnitude, ...]:
    """Returns the magnitudes of a failure over its runs with those of a further run.

    A measure that one of the runs does not have is left out: its other runs would not be a fair
    sample.
    """
    known = {magnitude.name: magnitude for magnitude in further}
    return tuple(
        replace(magnitude, values=(*magnitude.values, *known[magnitude.name].values))
        for magnitude in runs
        if magnitude.name in known
    )


def _number(value: object) -> float | None:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        return None
    return float(value)
