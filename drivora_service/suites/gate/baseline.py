"""The baseline of a suite: the failures that were accepted, a file to commit."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Literal

from drivora_service.oracles.verdict import Severity
from drivora_service.oracles.verdicts.accountability import IN_WORDS, Accountability
from drivora_service.oracles.verdicts.failure_definition import Counted, FailureDefinition
from drivora_service.oracles.verdicts.violation_magnitude import Magnitude, class_magnitude
from drivora_service.shapes import Shape
from drivora_service.suites.gate.severity_changes import compare_magnitudes
from drivora_service.suites.suite_failures import Failure, FailureKey, Found
from drivora_service.suites.suite_results import SuiteResults, SuiteRun

VERSION: Literal["1.0"] = "1.0"

METRIC_DIGITS = 6
"""Decimals of the means of metrics."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BaselineFailure(Shape):
    """A failure as it was accepted.

    Attributes:
        oracle: Violated oracle; `agent_failed`; or `metric NAME`.
        ego: Id of the ego; empty if it is of none.
        counterpart: Id of the other actor; empty without one.
        runs: Runs in which it occurred.
        accountability: The strongest of its violations.
        sentence: Facts of its first violation, for people.
        severities: The gravest severity of its violations in each run in which it occurred; empty
            in files of versions that did not record it.
        magnitudes: How severe it was in each of these runs, by measure; empty likewise.
    """

    oracle: str
    ego: str = ""
    counterpart: str = ""
    runs: int
    accountability: Accountability
    sentence: str = ""
    severities: tuple[Severity, ...] = ()
    magnitudes: tuple[Magnitude, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class BaselineScenario(Shape):
    """What was accepted of a scenario.

    Attributes:
        sha256: Hash of the scenario.
        seeds: Seeds of its judged runs.
        failures: What failed in them, sorted.
        metrics: Means of metrics over these runs, by name.
        counts: Violations that were failures; null: as the baseline says, and of versions that did
            not record it, not known.
        oracles: The only oracles that counted; null: all but observations, or likewise.
    """

    sha256: str
    seeds: tuple[int, ...]
    failures: tuple[BaselineFailure, ...] = ()
    metrics: Mapping[str, float] = field(default_factory=dict)
    counts: Counted | None = None
    oracles: tuple[str, ...] | None = None

    @property
    def definition(self) -> FailureDefinition | None:
        """What counted as a failure; ``None``: that is not known."""
        if self.counts is None:
            return None
        return FailureDefinition(counts=self.counts, oracles=self.oracles)


@dataclass(frozen=True, slots=True, kw_only=True)
class Baseline(Shape):
    """The accepted failures of a suite.

    Attributes:
        version: Version of this format.
        suite: Name of the suite.
        agent: ADS that drove; empty: as in the scenarios.
        agent_parameters: Its parameters that were set, as `NAME=VALUE`.
        configuration: The ADSs with the parameters that differ from their defaults; empty if the
            scenarios have different ones, and in files of versions that did not record it.
        versions: Versions of the software that took part, by name.
        counts: In a file: violations that were failures in scenarios that do not say it; null: that
            is not known of them.
        oracles: In a file: the only oracles that counted in these; null: all but observations.
        scenarios: By name.
    """

    version: Literal["1.0"] = VERSION
    suite: str
    agent: str
    agent_parameters: tuple[str, ...] = ()
    configuration: str = ""
    versions: Mapping[str, str] = field(default_factory=dict)
    counts: Counted | None = None
    oracles: tuple[str, ...] | None = None
    scenarios: Mapping[str, BaselineScenario]

    @property
    def subject(self) -> str:
        """The ADS with its parameters and the versions of the software, in words."""
        agent = self.agent or "the ADSs of the scenarios"
        driver = self.configuration or ", ".join((agent, *self.agent_parameters))
        versions = ", ".join(f"{name} {version}" for name, version in self.versions.items())
        return f"{driver}; {versions}" if versions else driver


@dataclass(frozen=True, slots=True, kw_only=True)
class BaselineChange:
    """A difference between two baselines.

    Attributes:
        scenario: Name of the scenario.
        what: The failure, or "" for the scenario itself.
        before: In words.
        after: In words.
    """

    scenario: str
    what: str
    before: str
    after: str


def make_baseline(results: SuiteResults, found: Found, *, metrics: Collection[str]) -> Baseline:
    """Returns the baseline that accepts what the runs of a suite show.

    Args:
        results: The runs.
        found: What they show.
        metrics: Names of the metrics whose means are kept.
    """
    by_scenario = results.of_scenario()
    scenarios: dict[str, BaselineScenario] = {}
    for name, sha256 in results.scenarios.items():
        runs = [run for run in by_scenario[name] if run not in found.unfinished]
        if not runs:
            # Nothing is known of it.
            continue
        scenarios[name] = BaselineScenario(
            sha256=sha256,
            seeds=tuple(run.seed for run in runs if run.seed is not None),
            failures=tuple(
                BaselineFailure(
                    oracle=key.oracle,
                    ego=key.ego,
                    counterpart=key.counterpart,
                    runs=failure.runs,
                    accountability=failure.accountability,
                    sentence=failure.sentence,
                    severities=failure.severities,
                    magnitudes=failure.magnitudes,
                )
                for key, failure in sorted(found.failures.items())
                if key.scenario == name
            ),
            metrics=_means(runs, metrics),
            counts=found.definitions[name].counts,
            oracles=found.definitions[name].oracles,
        )
    return Baseline(
        suite=results.suite,
        agent=results.agent,
        agent_parameters=results.agent_parameters,
        configuration="" if results.configuration is None else results.configuration.words,
        versions=results.versions,
        scenarios=scenarios,
    )


def baseline_changes(old: Baseline | None, new: Baseline) -> Iterator[BaselineChange]:
    """Yields the differences between two baselines, by scenario; ``None``: there was none."""
    known = {} if old is None else old.scenarios
    for name in sorted({*known, *new.scenarios}):
        before, after = known.get(name), new.scenarios.get(name)
        if before is None or after is None:
            yield BaselineChange(
                scenario=name,
                what="",
                before="not in the baseline" if before is None else _summary(before),
                after="not in the baseline" if after is None else _summary(after),
            )
            continue
        if before.sha256 != after.sha256:
            yield BaselineChange(
                scenario=name, what="", before="another scenario", after=_summary(after)
            )
        if before.definition is not None and before.definition != after.definition:
            yield BaselineChange(
                scenario=name,
                what="",
                before=f"counts {before.definition}",
                after=f"counts {after.definition}",
            )
        yield from _failure_changes(name, before, after)


def accepted_failures(
    scenarios: Mapping[str, BaselineScenario],
) -> dict[FailureKey, BaselineFailure]:
    """Returns the accepted failures of scenarios by their keys."""
    return {
        FailureKey(
            scenario=name,
            oracle=failure.oracle,
            ego=failure.ego,
            counterpart=failure.counterpart,
        ): failure
        for name, scenario in scenarios.items()
        for failure in scenario.failures
    }


def _failure_changes(
    name: str, before: BaselineScenario, after: BaselineScenario
) -> Iterator[BaselineChange]:
    old, new = accepted_failures({name: before}), accepted_failures({name: after})
    for key in sorted({*old, *new}):
        was, now = old.get(key), new.get(key)
        words = [
            "passes" if one is None else f"fails in {one.runs} of {len(scenario.seeds)}"
            for one, scenario in ((was, before), (now, after))
        ]
        if was is not None and now is not None:
            words[1] += "".join(f"; {change}" for change in _severity_changes(was, now))
            if was.accountability != now.accountability:
                for place, one in enumerate((was, now)):
                    words[place] += f"; {_account(one)}"
        if words[0] != words[1]:
            yield BaselineChange(
                scenario=name,
                what=str(key).removeprefix(f"{name}: "),
                before=words[0],
                after=words[1],
            )


def measured(failure: Failure | BaselineFailure | None) -> tuple[Magnitude, ...]:
    """Returns how severe a failure is in its runs, by its class and by the measures of its oracle.

    Empty for a failure that does not occur, and for one of a baseline that does not say.
    """
    if failure is None:
        return ()
    classes = (class_magnitude(failure.severities),) if failure.severities else ()
    return (*classes, *failure.magnitudes)


def _severity_changes(was: BaselineFailure, now: BaselineFailure) -> Iterator[str]:
    for change in compare_magnitudes(measured(was), measured(now)):
        if change.grows or change.shrinks:
            yield f"{'more' if change.grows else 'less'} severe: {change.words}"


def _account(failure: BaselineFailure) -> str:
    return IN_WORDS[failure.accountability] or "fault is not judged"


def _summary(scenario: BaselineScenario) -> str:
    count = len(scenario.failures)
    return f"{count} failure{'' if count == 1 else 's'} in {len(scenario.seeds)} runs"


def _means(runs: list[SuiteRun], names: Collection[str]) -> dict[str, float]:
    means = {}
    for name in sorted(names):
        values = [value for run in runs if (value := run.value_of(name)) is not None]
        if values:
            means[name] = round(sum(values) / len(values), METRIC_DIGITS)
    return means
