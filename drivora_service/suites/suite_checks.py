"""Whether results belong to a suite."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from drivora_service.errors import ConfigurationError
from drivora_service.suites.gate.baseline import Baseline
from drivora_service.suites.gate.gate_decision import plural
from drivora_service.suites.scenario_selection import read_shard
from drivora_service.suites.suite import Suite
from drivora_service.suites.suite_failures import is_judged
from drivora_service.suites.suite_results import SuiteResults, scenario_hash

_DOCUMENTED = "as in the scenarios"
"""The ADS of results without an ADS of their own."""


def check_shards(results: SuiteResults, suite: Suite) -> None:
    """Checks that no shard is missing among merged results.

    Raises:
        ConfigurationError: A shard is missing; its failures would be overlooked.
    """
    shards = {read_shard(text) for text in results.shards}
    missing = sorted(
        {f"{number}/{one.of}" for one in shards for number in range(1, one.of + 1)}
        - set(results.shards)
    )
    if missing and results.scenarios.keys() != suite.by_name.keys():
        raise ConfigurationError(
            f"these are the results of the shards {', '.join(results.shards)}, without "
            f"{', '.join(missing)}: name the results of all shards"
        )


def check_baseline(baseline: Baseline, results: SuiteResults) -> Iterator[str]:
    """Yields remarks on a baseline that is of another suite or another ADS than results."""
    for what, before, now in (
        ("suite", baseline.suite, results.suite),
        ("ADS", baseline.agent, results.agent),
    ):
        if before != now:
            yield (
                f"the baseline is of {what} {before or _DOCUMENTED!r}, and the results are of "
                f"{now or _DOCUMENTED!r}: what was accepted of one passes for the other"
            )


def check_results(results: SuiteResults, suite: Suite) -> Iterator[str]:
    """Yields remarks on results that are not those of a whole suite.

    Raises:
        ConfigurationError: They have a scenario that the suite does not have, or in another
            version.
    """
    scenarios = suite.by_name
    for name, sha256 in results.scenarios.items():
        if name not in scenarios:
            raise ConfigurationError(
                f"the results have a scenario {name!r}, and suite {suite.name!r} does not: they "
                "are of another suite, or of another version of it"
            )
        if scenario_hash(scenarios[name].document) != sha256:
            raise ConfigurationError(
                f"scenario {name!r} has changed since these results: run the suite again"
            )
    missing = [name for name in scenarios if name not in results.scenarios]
    if missing:
        yield f"{len(missing)} of {len(scenarios)} scenarios were not run: {_some(missing)}"


def check_judged(results: SuiteResults) -> Iterator[str]:
    """Yields a remark on scenarios without a judged run, which a baseline cannot have."""
    unjudged = [
        name for name, runs in results.of_scenario().items() if not any(map(is_judged, runs))
    ]
    if unjudged:
        yield f"{plural(len(unjudged), 'scenario')} without a judged run: {_some(unjudged)}"


def _some(names: Sequence[str]) -> str:
    return ", ".join(names[:5]) + (f" and {len(names) - 5} more" if names[5:] else "")
