"""Accepting the failures of results as the baseline of a suite."""

from __future__ import annotations

from dataclasses import replace

from drivora_service.errors import ConfigurationError
from drivora_service.suites.gate.baseline import Baseline, make_baseline
from drivora_service.suites.gate.gate_documents import GateDocument
from drivora_service.suites.reports.suite_report import SCORE
from drivora_service.suites.suite import Suite
from drivora_service.suites.suite_failures import find_failures
from drivora_service.suites.suite_results import SuiteResults


def update_baseline(
    results: SuiteResults, suite: Suite, gate: GateDocument, old: Baseline | None
) -> Baseline:
    """Returns the baseline that accepts what fails in results.

    Args:
        results: The results.
        suite: The suite; scenarios that it no longer has leave the baseline.
        gate: Says which violations count, and which metrics are compared with the baseline.
        old: The baseline so far, of which scenarios stay that the results do not have.

    Raises:
        ConfigurationError: The old baseline is of another suite or ADS, or scenarios of it stay,
            and other parameters were set.
    """
    if old is not None:
        for what, before, now in (
            ("suite", old.suite, results.suite),
            ("ADS", old.agent, results.agent),
        ):
            if before != now:
                raise ConfigurationError(
                    f"the baseline is of {what} {before!r}, and the results are of {now!r}; give "
                    "each its own file"
                )
    found = find_failures(results, suite.by_name, gate=gate.definition)
    metrics = {SCORE, *(one.metric for one in gate.metrics)}
    new = make_baseline(results, found, metrics=metrics)
    known = {} if old is None else old.scenarios
    kept = [name for name in suite.by_name if name in known and name not in new.scenarios]
    if old is not None and kept and old.agent_parameters != new.agent_parameters:
        raise ConfigurationError(
            f"the baseline is of the parameters {list(old.agent_parameters)}, and the results are "
            f"of {list(new.agent_parameters)} and have no judged run of {kept[0]!r}, which would "
            "stay: run the whole suite, or give each its own file"
        )
    scenarios = {**known, **new.scenarios}
    return replace(
        new, scenarios={name: scenarios[name] for name in suite.by_name if name in scenarios}
    )
