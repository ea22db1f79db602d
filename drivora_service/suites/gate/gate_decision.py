"""What a gate decided on the results of a suite, and why."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass

from drivora_service.oracles.verdicts.accountability import IN_WORDS
from drivora_service.oracles.verdicts.failure_definition import StatedDefinition
from drivora_service.suites.gate.baseline import BaselineFailure
from drivora_service.suites.gate.failure_classes import IN_ORDER, FailureClass
from drivora_service.suites.gate.occurrence_statistics import Interval, Occurrences
from drivora_service.suites.gate.severity_changes import SeverityChange, growth_in_words
from drivora_service.suites.suite_failures import Failure, FailureKey, KnownOccurrence
from drivora_service.suites.suite_results import SuiteRun

OCCURRENCE_TEST = "one-sided exact test of Fisher, corrected by Holm"


@dataclass(frozen=True, slots=True, kw_only=True)
class ClassifiedFailure:
    """A failure, now or in the baseline, with what has become of it.

    Attributes:
        now: ``None`` if it does not occur any more.
        before: ``None`` if it did not occur in the baseline, or there is none.
        in_runs: How often it occurs now.
        in_runs_before: How often it occurred; 0 of 0 if nothing is known of its scenario.
        p: That it occurs more often than before, corrected for the number of such tests; ``None``
            if that was not tested.
        fails: Whether the gate fails for it.
        severity: How severe it was and is, by each measure.
    """

    key: FailureKey
    failure_class: FailureClass
    now: Failure | None
    before: BaselineFailure | None
    in_runs: Occurrences
    in_runs_before: Occurrences
    p: float | None
    fails: bool
    severity: tuple[SeverityChange, ...] = ()

    @property
    def is_more_severe(self) -> bool:
        """Whether it is clearly more severe than before."""
        return any(one.is_worse for one in self.severity)

    @property
    def may_be_more_severe(self) -> bool:
        """Whether it is clearly more severe than before in the runs so far, if only by chance."""
        return any(one.is_worse or one.grows for one in self.severity)

    @property
    def sentence(self) -> str:
        """The facts of the failure."""
        if self.now is not None:
            return self.now.sentence
        return "" if self.before is None else self.before.sentence

    @property
    def change(self) -> str:
        """What has changed, in words."""
        now = _format_occurrences(self.in_runs)
        if not self.in_runs_before.of:
            return f"fails in {now}"
        before = _format_occurrences(self.in_runs_before)
        tested = "" if self.p is None else f" (p {self.p:.2g}, {OCCURRENCE_TEST})"
        parts = (f"fails in {now}, before in {before}{tested}", self.growth, self._accountabilities)
        return "; ".join(part for part in parts if part)

    @property
    def growth(self) -> str:
        """By which measures it is more severe than before, in words; "" if it is not."""
        return growth_in_words(self.severity)

    @property
    def _accountabilities(self) -> str:
        """The accountability before and now, if both are judged and differ."""
        if self.now is None or self.before is None:
            return ""
        was, now = IN_WORDS[self.before.accountability], IN_WORDS[self.now.accountability]
        return f"was {was}, is {now}" if was and now and was != now else ""


@dataclass(frozen=True, slots=True, kw_only=True)
class LimitAnswer:
    """The answer to one limit of a gate.

    Attributes:
        what: What is limited, in words.
        value: Its value, with a confidence interval if there are repetitions; ``None``: it is not
            measurable.
        allowed: What is allowed, in words.
        fails: Whether it is violated, for certain where there is an interval.
        is_uncertain: The value is beyond the limit, and the interval is not.
    """

    what: str
    value: Interval | None
    allowed: str
    fails: bool
    is_uncertain: bool = False

    @property
    def cells(self) -> tuple[str, str, str, str]:
        """The answer in the columns of a table: limit, value, allowed and result."""
        value = "not measurable" if self.value is None else str(self.value)
        result = "fails" if self.fails else "uncertain" if self.is_uncertain else "holds"
        return self.what, value, self.allowed, result


@dataclass(frozen=True, slots=True, kw_only=True)
class OverallAnswer:
    """Whether failures of all scenarios together occur more often than in the baseline.

    Attributes:
        before: Failing runs in the scenarios that both have.
        now: The same of these results.
        p: One-sided; ``None`` if no scenario can show a difference.
        scenarios: The strata of the test: scenarios with judged runs in both.
        telling: Those in which some runs fail and others do not; only these can show a difference.
    """

    before: Occurrences
    now: Occurrences
    p: float | None
    fails: bool
    scenarios: int
    telling: int

    @property
    def test(self) -> str:
        """The name of the test."""
        return (
            "one-sided test of Cochran, Mantel and Haenszel over "
            f"{plural(self.scenarios, 'scenario')}, {self.telling} with failing and passing runs"
        )

    @property
    def tested(self) -> str:
        """The p with its test, and what it compares; "" without a p."""
        if self.p is None:
            return ""
        return (
            f"p {self.p:.2g}, {self.test}; it compares scenario by scenario, so that the sums "
            "alone do not give this p"
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Decision:
    """The decision of a gate.

    Attributes:
        reasons: Why it fails, one sentence each; empty: it does not.
        failures: What fails, and what has changed, in the order of reports.
        has_baseline: Whether there was a baseline.
        limits: Of violations and of metrics.
        overall: ``None`` without a baseline, or if the gate does not ask for it.
        known: Known failures of the ADS.
        unfinished: Runs that were not judged.
        ignores_unfinished: Whether the gate may pass with such runs.
        not_in_baseline: Scenarios of which the baseline knows nothing, or another version.
        not_run: Scenarios of the baseline that were not run.
        scenarios: Scenarios that were run.
        failing_scenarios: Scenarios with a failure in any run.
        judged_runs: Runs that were judged.
        preventable_runs: Those with a violation that is not the fault of the ego, but avoidable,
            whether it counts or not.
        definition: What counts as a failure, without what is known of some ADSs.
    """

    reasons: tuple[str, ...]
    failures: tuple[ClassifiedFailure, ...]
    has_baseline: bool
    limits: tuple[LimitAnswer, ...]
    overall: OverallAnswer | None
    known: tuple[KnownOccurrence, ...]
    unfinished: tuple[SuiteRun, ...]
    ignores_unfinished: bool
    not_in_baseline: tuple[str, ...]
    not_run: tuple[str, ...]
    scenarios: int
    failing_scenarios: int
    judged_runs: int
    preventable_runs: int
    definition: StatedDefinition

    @property
    def definition_sentence(self) -> str:
        """What counts as a failure, in one sentence without its full stop."""
        number = self.definition.definitions
        by_scenario = f", by scenario ({number} definitions):" if number > 1 else ""
        return f"Failures are{by_scenario} {self.definition.words}"

    @property
    def fails(self) -> bool:
        """Whether the gate fails."""
        return bool(self.reasons)

    @property
    def counts(self) -> Mapping[FailureClass, int]:
        """The number of failures of each class, in the order of reports."""
        counted = Counter(one.failure_class for one in self.failures)
        return {which: counted[which] for which in IN_ORDER}

    @property
    def sentence(self) -> str:
        """How things stand, in one sentence."""
        word = "failed" if self.fails else "passed"
        if self.has_baseline:
            classes = ", ".join(f"{count} {which}" for which, count in self.counts.items() if count)
            found = f"{classes} against the baseline" if classes else "no failure, as before"
        else:
            found = plural(len(self.failures), "failure") if self.failures else "no failure"
        preventable = (
            f"; {plural(self.preventable_runs, 'run')} not at fault, but avoidable"
            if self.preventable_runs
            else ""
        )
        return (
            f"Gate {word}: {found}; {self.failing_scenarios} of {self.scenarios} scenarios fail "
            f"in {self.judged_runs} judged runs{preventable}"
        )


def plural(count: int, noun: str) -> str:
    """Returns a number of things in words."""
    return f"{count} {noun}{'' if count == 1 else 's'}"


def _format_occurrences(occurrences: Occurrences) -> str:
    return f"{occurrences.runs} of {plural(occurrences.of, 'run')}"
