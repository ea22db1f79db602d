"""The file of a baseline.

What counts as a failure is written once where all scenarios, or most of them, have it in common.
"""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import replace
from pathlib import Path

from pydantic import ValidationError

from drivora_service.errors import ConfigurationError
from drivora_service.given_names import describe_name_fault
from drivora_service.oracles.verdicts.failure_definition import FailureDefinition
from drivora_service.shapes import adapter, to_json
from drivora_service.suites.gate.baseline import Baseline, BaselineScenario


def read_baseline(path: Path) -> Baseline:
    """Reads a baseline file.

    Raises:
        ConfigurationError: It cannot be read, or holds something else.
    """
    try:
        baseline: Baseline = adapter(Baseline).validate_json(path.read_bytes())
    except OSError as error:
        raise ConfigurationError(
            f"{path} cannot be read: {error.strerror}; `drivora suite baseline` writes one"
        ) from error
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        place = "/".join(map(str, first["loc"])) or "the whole"
        raise ConfigurationError(f"{path} is no baseline: {place}: {first['msg']}") from error
    for place, name in (
        ("suite", baseline.suite),
        ("agent", baseline.agent),
        *(("scenarios", name) for name in baseline.scenarios),
    ):
        if fault := describe_name_fault(name):
            raise ConfigurationError(f"{path} is no baseline: {place}: {name[:80]!r}: {fault}")
    for name, scenario in baseline.scenarios.items():
        problem = _find_contradiction(scenario)
        if problem:
            raise ConfigurationError(f"{path} is no baseline: {name}: {problem}")
    return _with_definitions(baseline)


def baseline_text(baseline: Baseline) -> str:
    """Writes a baseline as JSON that is good to compare line by line."""
    content = json.loads(to_json(Baseline, _with_common_definition(baseline)))
    for part in (content, *content["scenarios"].values()):
        if part["counts"] is None:
            del part["counts"], part["oracles"]
    return json.dumps(content, indent=1, ensure_ascii=False) + "\n"


def _find_contradiction(scenario: BaselineScenario) -> str:
    """Returns what cannot be in a scenario, in words; "" if there is nothing."""
    for failure in scenario.failures:
        if not 1 <= failure.runs <= len(scenario.seeds):
            return f"{failure.oracle} occurs in {failure.runs} of {len(scenario.seeds)} runs"
        for magnitude in failure.magnitudes:
            if len(magnitude.values) != failure.runs:
                return (
                    f"{failure.oracle} occurs in {failure.runs} runs, and {magnitude.name} has "
                    f"{len(magnitude.values)} values"
                )
    return ""


def _with_definitions(baseline: Baseline) -> Baseline:
    """Returns the baseline with the common definition in each scenario that has none."""
    if baseline.counts is None:
        return baseline
    scenarios = {
        name: one
        if one.counts is not None
        else replace(one, counts=baseline.counts, oracles=baseline.oracles)
        for name, one in baseline.scenarios.items()
    }
    return replace(baseline, counts=None, oracles=None, scenarios=scenarios)


def _with_common_definition(baseline: Baseline) -> Baseline:
    """Returns the baseline with the most frequent definition stated once, if all are known."""
    definitions: list[FailureDefinition] = []
    for one in baseline.scenarios.values():
        if one.definition is None:
            # Beside a common definition it would seem to be known.
            return baseline
        definitions.append(one.definition)
    if not definitions:
        return baseline
    ((common, _),) = Counter(definitions).most_common(1)
    scenarios = {
        name: replace(one, counts=None, oracles=None) if one.definition == common else one
        for name, one in baseline.scenarios.items()
    }
    return replace(baseline, counts=common.counts, oracles=common.oracles, scenarios=scenarios)
