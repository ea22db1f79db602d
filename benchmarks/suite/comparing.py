"""The comparison of two results."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum

from benchmarks.suite.result import Better, Quantity, Series, SuiteResult


class Finding(StrEnum):
    """What the comparison says about a quantity."""

    BETTER = "better"
    WORSE = "worse"
    DIFFERENT = "different"
    WITHIN = "within the spread"
    UNKNOWN = "spread unknown"


@dataclass(frozen=True, slots=True, kw_only=True)
class Difference:
    """A quantity in two results.

    Attributes:
        section: Name of the measurement.
        quantity: The quantity.
        one: Its values in the first result.
        other: Its values in the second result.
    """

    section: str
    quantity: Quantity
    one: Series
    other: Series

    @property
    def ratio(self) -> float:
        """Median of the second result over that of the first; NaN if the first is 0."""
        return _over(self.other.median, self.one.median)

    @property
    def spread(self) -> tuple[float, float]:
        """Smallest and largest ratio between any two rounds of the results."""
        return _over(self.other.low, self.one.high), _over(self.other.high, self.one.low)

    @property
    def finding(self) -> Finding:
        """Whether the results differ by more than their rounds do.

        They do if their ranges have no value in common. One round has no range.
        """
        if min(len(self.one.values), len(self.other.values)) < 2:
            return Finding.UNKNOWN
        if self.one.low <= self.other.high and self.other.low <= self.one.high:
            return Finding.WITHIN
        if self.quantity.better is Better.NEITHER:
            return Finding.DIFFERENT
        higher = self.other.median > self.one.median
        return (
            Finding.BETTER if higher == (self.quantity.better is Better.HIGHER) else Finding.WORSE
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """Two results beside each other.

    Attributes:
        warnings: Why they can hardly be compared.
        differences: The quantities that both have.
        only_one: Quantities of the first alone, with the names of their measurements.
        only_other: Quantities of the second alone.
    """

    warnings: tuple[str, ...]
    differences: tuple[Difference, ...]
    only_one: tuple[tuple[str, Quantity], ...]
    only_other: tuple[tuple[str, Quantity], ...]


def compare(one: SuiteResult, other: SuiteResult) -> Comparison:
    """Compares two results, the second with the first."""
    ours, theirs = _by_quantity(one), _by_quantity(other)
    return Comparison(
        warnings=tuple(_warnings(one, other)),
        differences=tuple(
            Difference(section=key[0], quantity=key[1], one=series, other=theirs[key])
            for key, series in ours.items()
            if key in theirs
        ),
        only_one=tuple(key for key in ours if key not in theirs),
        only_other=tuple(key for key in theirs if key not in ours),
    )


def table(comparison: Comparison) -> str:
    """Returns a comparison as text."""
    lines = [f"Careful: {warning}." for warning in comparison.warnings]
    section = ""
    for difference in comparison.differences:
        if difference.section != section:
            section = difference.section
            lines += ["", section]
        quantity, (low, high) = difference.quantity, difference.spread
        lines.append(
            f"  {quantity.case + ': ' + quantity.name:<62} {difference.ratio:7.3f} "
            f"({low:.3f} to {high:.3f})  {difference.finding}"
        )
    for what, keys in (("first", comparison.only_one), ("second", comparison.only_other)):
        if keys:
            lines += ["", f"Only in the {what} result:"]
            lines += [f"  {name}: {quantity.case}: {quantity.name}" for name, quantity in keys]
    counts = {
        finding: sum(one.finding is finding for one in comparison.differences)
        for finding in Finding
    }
    told = ", ".join(f"{count} {finding}" for finding, count in counts.items() if count)
    lines += ["", f"{len(comparison.differences)} quantities: {told or 'none'}."]
    return "\n".join(lines).lstrip("\n") + "\n"


def _by_quantity(result: SuiteResult) -> dict[tuple[str, Quantity], Series]:
    return {
        (section.name, series.quantity): series
        for section in result.sections
        for series in section.series
    }


def _warnings(one: SuiteResult, other: SuiteResult) -> Iterator[str]:
    ours, theirs = one.machine, other.machine
    if (ours.cpu, ours.cores) != (theirs.cpu, theirs.cores):
        yield (
            f"different machines, {ours.cores} cores of {ours.cpu} and {theirs.cores} of "
            f"{theirs.cpu}; only ratios can be compared"
        )
    if ours.nice != theirs.nice:
        yield f"different priorities, nice {ours.nice} and {theirs.nice}"
    for name, result in (("first", one), ("second", other)):
        busy = result.machine.load[0]
        if busy > result.machine.cores:
            yield f"the load was {busy:.1f} on {result.machine.cores} cores in the {name} result"
        if result.short:
            yield f"the {name} result is of the short form"


def _over(value: float, base: float) -> float:
    return value / base if base else float("nan")
