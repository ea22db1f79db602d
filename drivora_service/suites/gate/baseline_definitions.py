"""Whether a baseline counts the failures that the results of a suite are judged by."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from drivora_service.errors import ConfigurationError
from drivora_service.oracles.verdicts.failure_definition import FailureDefinition
from drivora_service.suites.gate.baseline import Baseline, BaselineScenario
from drivora_service.suites.suite import SuiteScenario
from drivora_service.suites.suite_results import SuiteResults


def check_definitions(
    baseline: Baseline,
    hashes: Mapping[str, str],
    scenarios: Mapping[str, SuiteScenario],
    gate: FailureDefinition,
) -> None:
    """Checks that a baseline counts the same violations as the suite and the gate do now.

    A baseline keeps what counted only. So what counts now and did not count then is not known to
    be new, and what does not count any more is not known to be fixed. Baselines that do not say
    what they count are taken to count the same.

    Args:
        baseline: The accepted failures.
        hashes: Hashes of the scenarios that are judged, by name.
        scenarios: Expectations by the name of the scenario.
        gate: What counts in scenarios that do not say it themselves.

    Raises:
        ConfigurationError: It counts others in a scenario that is compared with it.
    """
    different: dict[str, tuple[FailureDefinition, FailureDefinition]] = {}
    compared = find_comparable(baseline, hashes)
    for name, one in compared.items():
        # A failure that is known from now on is left out of what was accepted.
        now = replace(scenarios[name].definition(gate), known=())
        if one.definition is not None and one.definition != now:
            different[name] = (one.definition, now)
    if different:
        name, (before, now) = next(iter(different.items()))
        raise ConfigurationError(
            f"the baseline and this gate count different failures in {len(different)} of "
            f"{len(compared)} scenarios, so that it cannot be said what is new or fixed. In "
            f"{name!r} the baseline counts {before}; the suite and the gate file count {now}. "
            "Allowed: the same `counts` and `oracles`. Make the baseline anew (`drivora suite "
            "baseline`, with the results that it was made of), or state in the suite or the gate "
            "file what it counts"
        )


def find_comparable(
    baseline: Baseline | None, hashes: Mapping[str, str]
) -> dict[str, BaselineScenario]:
    """Returns what a baseline knows of scenarios in the versions that are judged."""
    if baseline is None:
        return {}
    return {
        name: baseline.scenarios[name]
        for name, sha256 in hashes.items()
        if name in baseline.scenarios
        and baseline.scenarios[name].sha256 == sha256
        and baseline.scenarios[name].seeds
    }


def leave_out_known(
    comparable: Mapping[str, BaselineScenario],
    results: SuiteResults,
    definitions: Mapping[str, FailureDefinition],
) -> dict[str, BaselineScenario]:
    """Returns what was accepted without the failures that are known now: they are not fixed.

    Args:
        comparable: What was accepted, by scenario.
        results: The runs, whose ADSs say what is known of them.
        definitions: What counts in each scenario now.
    """
    runs = results.of_scenario()
    return {
        name: replace(
            one,
            failures=tuple(
                failure
                for failure in one.failures
                if not runs[name]
                or not all(
                    definitions[name].knows(
                        failure.oracle, failure.ego, failure.counterpart, run.agents
                    )
                    for run in runs[name]
                )
            ),
        )
        for name, one in comparable.items()
    }
