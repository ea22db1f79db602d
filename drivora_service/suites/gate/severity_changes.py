"""Whether failures that occurred before are clearly more severe now."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from drivora_service.oracles.verdicts.violation_magnitude import Magnitude
from drivora_service.studies.comparison.sample_statistics import holm

SEVERITY_TEST = "one-sided rank test of Mann and Whitney, corrected by Holm"

_MOST_EXACT = 100
"""Runs up to which the test counts all divisions of the ranks."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SeverityChange:
    """How severe a failure was and is, by one measure.

    Attributes:
        before: In the runs of the baseline in which it occurred; ``None``: it did not occur, or the
            baseline does not say.
        now: In the runs in which it occurs now; ``None`` likewise.
        p: That the runs now are more severe, corrected for the number of such tests; ``None`` if
            that was not tested.
        is_worse: Whether it is clearly more severe now, and that is no chance.
    """

    before: Magnitude | None
    now: Magnitude | None
    p: float | None = None
    is_worse: bool = False

    @property
    def measure(self) -> Magnitude:
        """The measure, with the values of one side."""
        found = self.now or self.before
        assert found is not None, "one side is known"
        return found

    @property
    def grows(self) -> bool:
        """Whether the median now is clearly worse than the median before."""
        if self.before is None or self.now is None:
            return False
        return self.now.is_clearly_worse(self.before.median, self.now.median)

    @property
    def shrinks(self) -> bool:
        """Whether the median before is clearly worse than the median now."""
        if self.before is None or self.now is None:
            return False
        return self.now.is_clearly_worse(self.now.median, self.before.median)

    @property
    def words(self) -> str:
        """The medians before and now, with their unit."""
        measure = self.measure
        values = [measure.format(one.median) for one in (self.before, self.now) if one is not None]
        unit = f" {measure.unit}" if measure.unit not in ("", "1") else ""
        return f"{measure.words} {' → '.join(values)}{unit}"

    @property
    def tested_words(self) -> str:
        """The medians, with the p and its test if there was one."""
        return self.words if self.p is None else f"{self.words} (p {self.p:.2g}, {SEVERITY_TEST})"


@dataclass(frozen=True, slots=True, kw_only=True)
class SeveritySides:
    """The magnitudes of one failure before and now.

    Attributes:
        in_every_run: Whether it occurs in every run now.
    """

    before: tuple[Magnitude, ...]
    now: tuple[Magnitude, ...]
    in_every_run: bool


def growth_in_words(changes: Iterable[SeverityChange]) -> str:
    """Returns by which measures a failure is more severe than before; "" if it is by none."""
    grown = [one for one in changes if one.grows]
    kinds = (
        ("more severe", [one.tested_words for one in grown if one.is_worse]),
        ("more severe, perhaps by chance", [one.tested_words for one in grown if not one.is_worse]),
    )
    return "; ".join(f"{kind}: {', '.join(words)}" for kind, words in kinds if words)


def compare_magnitudes(
    before: Iterable[Magnitude], now: Iterable[Magnitude]
) -> tuple[SeverityChange, ...]:
    """Returns the changes of one failure by each measure that either side has, without a test."""
    old, new = ({one.name: one for one in side} for side in (before, now))
    return tuple(
        SeverityChange(before=old.get(name), now=new.get(name))
        for name in dict.fromkeys([*new, *old])
    )


def severity_changes(
    failures: Sequence[SeveritySides], *, alpha: float
) -> list[tuple[SeverityChange, ...]]:
    """Returns what has changed in the severity of failures, and whether they are worse by it.

    A failure is clearly more severe if it occurs in every run now, and each is clearly worse than
    every one before, by more than the runs of either side differ among themselves. Otherwise, its
    median must be clearly worse, and the test of ranks significant: the greatest of more runs is no
    evidence.

    Args:
        failures: Those that occur before or now.
        alpha: The p below which a test is trusted, over all failures.
    """
    found = [list(compare_magnitudes(one.before, one.now)) for one in failures]
    tested: list[tuple[int, int]] = []
    for place, sides in enumerate(failures):
        for index, change in enumerate(found[place]):
            if change.before is None or change.now is None:
                continue
            if sides.in_every_run and _is_apart(change.before, change.now):
                found[place][index] = replace(change, is_worse=True)
            elif len({*change.before.values, *change.now.values}) > 1:
                tested.append((place, index))
    # All whose runs differ count for the correction, also those that have too few runs as yet:
    # which ones get further runs depends on their first ones.
    p_values = holm([_p_of_change(found[place][index]) for place, index in tested])
    for (place, index), p in zip(tested, p_values, strict=True):
        change = found[place][index]
        found[place][index] = replace(change, p=p, is_worse=change.grows and p < alpha)
    return [tuple(one) for one in found]


def _is_apart(before: Magnitude, now: Magnitude) -> bool:
    """Returns whether all runs now are clearly worse, by more than those of a side differ."""
    gap = abs(now.least - before.worst)
    spread = max(abs(side.worst - side.least) for side in (before, now))
    return now.is_clearly_worse(before.worst, now.least) and gap >= spread


def _p_of_change(change: SeverityChange) -> float:
    if change.before is None or change.now is None:
        return 1.0
    sign = -1.0 if change.now.less_is_worse else 1.0
    return p_of_greater(
        [sign * value for value in change.before.values],
        [sign * value for value in change.now.values],
    )


def p_of_greater(before: Sequence[float], now: Sequence[float]) -> float:
    """Returns the one-sided p of the rank test of Mann and Whitney that values are greater now.

    Exact, with ties: the share of all divisions of the values into two groups of these sizes in
    which the ranks of the second group have at least the observed sum. Above a hundred values, by
    the normal distribution.

    Args:
        before: At least one value.
        now: At least one value.
    """
    # Imported here: importing it takes half a second, which commands without a gate skip.
    import numpy as np
    from scipy import stats

    values = [*before, *now]
    if len(values) > _MOST_EXACT:
        test = stats.mannwhitneyu(now, before, alternative="greater", method="asymptotic")
        return float(test.pvalue)
    # Doubled, the ranks of ties are whole numbers, too.
    ranks = np.rint(2.0 * stats.rankdata(values)).astype(np.int64)
    # Number of ways in which so many of the values seen so far have such a sum of ranks.
    ways = np.zeros((len(now) + 1, int(ranks.sum()) + 1))
    ways[0, 0] = 1.0
    for rank in ranks:
        ways[1:, rank:] += ways[:-1, :-rank].copy()
    observed = int(ranks[len(before) :].sum())
    return float(ways[-1, observed:].sum() / ways[-1].sum())
