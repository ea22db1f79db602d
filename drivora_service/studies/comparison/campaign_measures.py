"""Comparing methods over repeated campaigns, measure by measure, scenario by scenario."""

from __future__ import annotations

import statistics
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

from pydantic import computed_field

from drivora_service.errors import CampaignError, UnknownName
from drivora_service.shapes import Shape, combine
from drivora_service.studies.campaign_figures import CampaignFigures, Subject
from drivora_service.studies.comparison.sample_statistics import compare_samples, holm

LARGE_EFFECT = 0.71
"""A12 from which an effect is called large (Vargha and Delaney 2000)."""
SIGNIFICANT = 0.05
_SIZES = ((LARGE_EFFECT, "large"), (0.64, "medium"), (0.56, "small"))
"""A12, or 1 minus A12, from which an effect has the name (Vargha and Delaney 2000)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Measure:
    """A measure of campaigns.

    Attributes:
        value: Returns its value for a campaign; ``None`` if the campaign has none.
    """

    name: str
    title: str
    larger_is_better: bool
    value: Callable[[CampaignFigures], float | None]


def _until(first: int | None, figures: CampaignFigures) -> float | None:
    """Returns the simulations up to a first failure; the budget plus one if there was none.

    A tester may have ended before its budget: with one more than it made, the tester that gave up
    first would seem to have found a failure first. At equal time the numbers of simulations differ
    as well, and there is no budget: then the result is ``None``.
    """
    if figures.time_limit_s is not None:
        return None
    if first is not None:
        return float(first)
    return float(max(figures.simulations, figures.budget or 0) + 1)


def _seconds_until(first_s: float | None, figures: CampaignFigures) -> float | None:
    """Returns the seconds to a first failure; at equal time all seconds if there was none."""
    return figures.time_limit_s if first_s is None else first_s


MEASURES = (
    Measure(
        name="avoidable",
        title="simulations with an avoidable at-fault failure",
        larger_is_better=True,
        value=lambda f: float(f.avoidable),
    ),
    Measure(
        name="first_avoidable",
        title="simulations to the first avoidable at-fault failure",
        larger_is_better=False,
        value=lambda f: _until(f.first_avoidable, f),
    ),
    Measure(
        name="first_avoidable_s",
        title="seconds to the first avoidable at-fault failure",
        larger_is_better=False,
        value=lambda f: _seconds_until(f.first_avoidable_s, f),
    ),
    Measure(
        name="avoidable_kinds",
        title="kinds of avoidable at-fault failures",
        larger_is_better=True,
        value=lambda f: float(f.avoidable_kinds),
    ),
    Measure(
        name="avoidable_situations",
        title="situations with an avoidable at-fault failure",
        larger_is_better=True,
        value=lambda f: float(f.avoidable_situations),
    ),
    Measure(
        name="at_fault",
        title="simulations with an at-fault failure",
        larger_is_better=True,
        value=lambda f: float(f.at_fault),
    ),
    Measure(
        name="failing",
        title="simulations with a failure",
        larger_is_better=True,
        value=lambda f: float(f.failing),
    ),
    Measure(
        name="kinds",
        title="kinds of failures",
        larger_is_better=True,
        value=lambda f: float(f.kinds),
    ),
    Measure(
        name="situations",
        title="situations with a failure",
        larger_is_better=True,
        value=lambda f: float(f.situations),
    ),
    Measure(
        name="oracles",
        title="oracles violated",
        larger_is_better=True,
        value=lambda f: float(f.oracles),
    ),
    Measure(
        name="first_failure",
        title="simulations to the first failure",
        larger_is_better=False,
        value=lambda f: _until(f.first_failure, f),
    ),
    Measure(
        name="first_failure_s",
        title="seconds to the first failure",
        larger_is_better=False,
        value=lambda f: _seconds_until(f.first_failure_s, f),
    ),
    Measure(
        name="gene_coverage",
        title="coverage of the gene space",
        larger_is_better=True,
        value=lambda f: f.gene_coverage,
    ),
    Measure(
        name="network_coverage",
        title="coverage of the road network",
        larger_is_better=True,
        value=lambda f: f.network_coverage,
    ),
    Measure(
        name="law_coverage",
        title="coverage of violations of traffic laws",
        larger_is_better=True,
        value=lambda f: f.law_coverage,
    ),
    Measure(
        name="invalid_share",
        title="share of invalid candidates",
        larger_is_better=False,
        value=lambda f: f.invalid_share,
    ),
    Measure(
        name="unchanged_share",
        title="share of candidates with their parent's run",
        larger_is_better=False,
        value=lambda f: f.unchanged_share,
    ),
    Measure(
        name="own_share",
        title="own time over simulation time",
        larger_is_better=False,
        value=lambda f: f.own_share,
    ),
)


def measure(name: str) -> Measure:
    """Returns a measure by its name.

    Raises:
        UnknownName: There is no measure of that name.
    """
    for known in MEASURES:
        if known.name == name:
            return known
    raise UnknownName("measure", name, tuple(known.name for known in MEASURES))


@dataclass(frozen=True, slots=True, kw_only=True)
class Difference(Shape):
    """One method against the baseline, by one measure on one seed scenario.

    Attributes:
        measure: Name of the measure.
        title: Display name of the measure.
        method: The method: campaigns of one method are repetitions.
        repetitions: Number of repetitions of the method.
        baseline_repetitions: Number of repetitions of the baseline.
        median: Median of the method's repetitions.
        baseline_median: Median of the baseline's repetitions.
        a12: Probability that a repetition of the method is *better* than one of the baseline.
        low: Lower end of its 95 % confidence interval.
        high: Upper end.
        p: p-value of the two-sided Mann-Whitney test.
        p_holm: p corrected for all differences by the same measure.
    """

    measure: str
    title: str
    larger_is_better: bool
    scenario: str
    method: str
    baseline: str
    repetitions: int
    baseline_repetitions: int
    median: float
    baseline_median: float
    a12: float
    low: float
    high: float
    p: float
    p_holm: float

    @property
    def is_better(self) -> bool:
        """Whether the method is better by a large and significant effect."""
        return self.a12 >= LARGE_EFFECT and self.p_holm < SIGNIFICANT

    @computed_field  # type: ignore[prop-decorator] # as pydantic documents it
    @property
    def judgement(self) -> str:
        """In words: better or worse and by how much, or undecided if not significant."""
        if self.p_holm >= SIGNIFICANT:
            return "undecided"
        larger = max(self.a12, 1.0 - self.a12)
        # The words for the size are those of Vargha and Delaney 2000.
        size = next((word for least, word in _SIZES if larger >= least), "negligible")
        return f"{'better' if self.a12 > 0.5 else 'worse'}, {size}"


def compare_campaigns(
    figures: Sequence[CampaignFigures], baseline: str, measures: Sequence[Measure] = MEASURES
) -> tuple[Difference, ...]:
    """Compares every method with a baseline.

    Args:
        figures: Figures of campaigns with the same budget on each seed scenario.
        baseline: Name of the method that the others are compared with.
        measures: Measures to compare by.

    Returns:
        Differences by measure, then scenario, then method; none for a measure without a value in a
        campaign of either method.

    Raises:
        CampaignError: The campaigns cannot be compared; the message says why.
    """
    check_comparable(figures, baseline)
    rows = []
    for by in measures:
        found = [
            row
            for scenario in _unique(f.scenario for f in figures)
            for method in _unique(f.method for f in figures if f.scenario == scenario)
            if method != baseline
            and (row := _row(figures, scenario, method, baseline, by)) is not None
        ]
        # A family for each measure: each is a question of its own, asked at all places.
        corrected = holm([row.p for row in found])
        rows += [replace(row, p_holm=p) for row, p in zip(found, corrected, strict=True)]
    return tuple(rows)


def check_comparable(figures: Sequence[CampaignFigures | Subject], baseline: str) -> None:
    """Checks that every method has repetitions, and a baseline to be compared with.

    Args:
        figures: The campaigns, with or without figures.
        baseline: Name of the method that the others are compared with.

    Raises:
        CampaignError: The campaigns cannot be compared; the message says why.
    """
    methods = _unique(f.method for f in figures)
    if baseline not in methods:
        raise CampaignError(
            f"there is no campaign of {baseline!r} to compare with; there are: {', '.join(methods)}"
        )
    if len(methods) < 2:
        raise CampaignError(f"all campaigns are of {baseline!r}: there is nothing to compare")
    for scenario in _unique(f.scenario for f in figures):
        here = [f for f in figures if f.scenario == scenario]
        if not any(f.method == baseline for f in here):
            raise CampaignError(f"on {scenario!r} there is no campaign of {baseline!r}")
        for method in _unique(f.method for f in here):
            if sum(f.method == method for f in here) < 2:
                raise CampaignError(
                    f"on {scenario!r} there is one campaign of {method!r} only; a difference can "
                    "be told from chance only with repetitions: run it with other seeds, 20 in all "
                    "for a reliable result"
                )
        seen: dict[tuple[str, int], str] = {}
        for f in here:
            twin = seen.setdefault((f.method, f.seed), f.campaign)
            if twin != f.campaign:
                raise CampaignError(
                    f"campaigns {twin} and {f.campaign} are the same search ({f.method}, seed "
                    f"{f.seed}): repetitions need seeds of their own"
                )


def _row(
    figures: Sequence[CampaignFigures], scenario: str, method: str, baseline: str, by: Measure
) -> Difference | None:
    first = [by.value(f) for f in figures if (f.scenario, f.method) == (scenario, method)]
    second = [by.value(f) for f in figures if (f.scenario, f.method) == (scenario, baseline)]
    ours = [value for value in first if value is not None]
    theirs = [value for value in second if value is not None]
    if len(ours) < len(first) or len(theirs) < len(second):
        return None
    sign = 1.0 if by.larger_is_better else -1.0
    effect = compare_samples([sign * v for v in ours], [sign * v for v in theirs])
    return combine(
        Difference,
        effect,
        measure=by.name,
        title=by.title,
        larger_is_better=by.larger_is_better,
        scenario=scenario,
        method=method,
        baseline=baseline,
        repetitions=len(ours),
        baseline_repetitions=len(theirs),
        median=statistics.median(ours),
        baseline_median=statistics.median(theirs),
        p_holm=1.0,
    )


def _unique(names: Iterable[str]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(names))
