"""The results of a suite: its runs, as they are judged, stored in a file and merged."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal

from pydantic import ValidationError

from drivora_service.agents.configuration import AgentConfiguration
from drivora_service.errors import ConfigurationError
from drivora_service.oracles.verdict import Verdict
from drivora_service.runs.run_report import RunStatus
from drivora_service.scenario.documents import ScenarioDocument, document_text
from drivora_service.shapes import Shape, adapter, to_json
from drivora_service.suites.suite_documents import EXTENSION

VERSION: Literal["1.0"] = "1.0"


@dataclass(frozen=True, slots=True, kw_only=True)
class SuiteRun(Shape):
    """One run of a scenario of a suite.

    Attributes:
        scenario: Name of the scenario.
        repetition: From 0; those after the suite's own are confirmations.
        seed: Seed of the run; null if it could not be run.
        run_id: Id of the run; empty if it could not be run.
        cause: Why the run was not judged; empty otherwise.
        message: The reason in words; empty otherwise.
        town: Name of the road network.
        agents: Name of each ego's ADS, by the ego's id.
        configuration: The ADSs with the parameters that differ from their defaults; empty in files
            of versions that did not record it.
        configuration_id: Short id of the ADSs with all their parameters; empty likewise.
        violations: Violated verdicts.
        metrics: Measured values by name; null: not measurable.
        trace_sha256: Hash of the trace; empty where nothing was recorded.
        sim_time_s: Simulated seconds; null if it did not run.
        wall_time_s: Seconds that the run took in its worker; null if it did not run.
    """

    scenario: str
    repetition: int
    seed: int | None
    run_id: str
    status: RunStatus
    cause: str = ""
    message: str = ""
    town: str = ""
    agents: Mapping[str, str] = field(default_factory=dict)
    configuration: str = ""
    configuration_id: str = ""
    violations: tuple[Verdict, ...] = ()
    metrics: Mapping[str, float | None] = field(default_factory=dict)
    trace_sha256: str = ""
    sim_time_s: float | None = None
    wall_time_s: float | None = None

    def value_of(self, metric: str) -> float | None:
        """Returns the value of a metric, or of one for an ego, ``NAME[EGO]``.

        A run with a single ego has no values by ego: its own are those of this ego.
        """
        name, bracket, ego = metric.partition("[")
        if bracket and metric not in self.metrics and list(self.agents) == [ego[:-1]]:
            return self.metrics.get(name)
        return self.metrics.get(metric)


@dataclass(frozen=True, slots=True, kw_only=True)
class SuiteResults(Shape):
    """The runs of a suite, or of a part of it.

    Attributes:
        version: Version of this format.
        suite: Name of the suite.
        agent: ADS that drove every ego; empty: as in the scenarios.
        agent_parameters: Its parameters that were set, as `NAME=VALUE`.
        size: Number of scenarios of the whole suite.
        repetitions: Runs of each scenario, without confirmations.
        scenarios: Hash of each scenario that was run, by its name.
        shards: Shards of which these are the results, such as `2/4`; empty: not a shard.
        versions: Versions of the software that took part, by name.
        oracles: Names of the oracles that judged, sorted; empty in files of versions that did not
            record them. By these the results are decided on without the packages of oracles.
        runs: The runs, in the order of the suite and of their repetitions.
    """

    version: Literal["1.0"] = VERSION
    suite: str
    agent: str
    agent_parameters: tuple[str, ...] = ()
    size: int
    repetitions: int
    scenarios: Mapping[str, str]
    shards: tuple[str, ...] = ()
    versions: Mapping[str, str] = field(default_factory=dict)
    oracles: tuple[str, ...] = ()
    runs: tuple[SuiteRun, ...]

    @property
    def configuration(self) -> AgentConfiguration | None:
        """The ADS of all runs with its parameters; ``None`` if they have several or none."""
        found = {
            AgentConfiguration(words=run.configuration, id=run.configuration_id)
            for run in self.runs
            if run.configuration_id
        }
        return found.pop() if len(found) == 1 else None

    @property
    def judged_by(self) -> frozenset[str]:
        """The oracles of which it is known that they judged."""
        violated = {verdict.oracle for run in self.runs for verdict in run.violations}
        return frozenset({*self.oracles, *violated})

    @property
    def measured(self) -> frozenset[str]:
        """The metrics that runs have, without those of single egos."""
        return frozenset(name.partition("[")[0] for run in self.runs for name in run.metrics)

    def of_scenario(self) -> dict[str, list[SuiteRun]]:
        """Returns the runs of each scenario."""
        found: dict[str, list[SuiteRun]] = {name: [] for name in self.scenarios}
        for run in self.runs:
            found[run.scenario].append(run)
        return found

    def without_confirmations(self) -> SuiteResults:
        """Returns the runs that were chosen before anything was known of their results."""
        return replace(
            self, runs=tuple(run for run in self.runs if run.repetition < self.repetitions)
        )

    def with_runs(self, runs: Sequence[SuiteRun]) -> SuiteResults:
        """Returns these results with further runs of their scenarios."""
        order = {name: place for place, name in enumerate(self.scenarios)}
        every = sorted((*self.runs, *runs), key=lambda run: (order[run.scenario], run.repetition))
        return replace(self, runs=tuple(every))


def scenario_hash(document: ScenarioDocument) -> str:
    """Returns the hash by which a changed scenario of a suite is noticed."""
    return hashlib.sha256(document_text(remove_expectations(document)).encode()).hexdigest()


def remove_expectations(document: ScenarioDocument) -> ScenarioDocument:
    """Returns a scenario without what it says on expectations: they are no part of a run."""
    kept = {key: value for key, value in document.extensions.items() if key != EXTENSION}
    return document.model_copy(update={"extensions": kept})


def results_text(results: SuiteResults) -> str:
    """Writes results as JSON that reads back to equal ones."""
    content = json.loads(to_json(SuiteResults, results))
    return json.dumps(content, indent=1, ensure_ascii=False) + "\n"


def read_results(path: Path) -> SuiteResults:
    """Reads a file of results.

    Raises:
        ConfigurationError: It cannot be read, or holds something else.
    """
    try:
        results: SuiteResults = adapter(SuiteResults).validate_json(path.read_bytes())
    except OSError as error:
        raise ConfigurationError(f"{path} cannot be read: {error.strerror}") from error
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        place = "/".join(map(str, first["loc"]))
        raise ConfigurationError(
            f"{path} holds no results of `drivora suite run --results`: {place or 'the whole'}: "
            f"{first['msg']}"
        ) from error
    strange = {run.scenario for run in results.runs} - results.scenarios.keys()
    if strange:
        raise ConfigurationError(
            f"{path} holds runs of scenarios that it does not list: {', '.join(sorted(strange))}"
        )
    return results


def merge_results(parts: Sequence[SuiteResults]) -> SuiteResults:
    """Merges the results of parts of one suite, such as its shards.

    Raises:
        ConfigurationError: They are of different suites, ADSs or scenarios, or two have the same
            run.
    """
    first, *others = parts
    for other in others:
        for what, one, two in (
            ("suites", first.suite, other.suite),
            ("ADSs", first.agent, other.agent),
            ("numbers of repetitions", first.repetitions, other.repetitions),
            ("parameters", list(first.agent_parameters), list(other.agent_parameters)),
        ):
            if one != two:
                raise ConfigurationError(
                    f"these results are of different {what}: {one!r} and {two!r}; merge only "
                    "parts of one suite that one ADS has driven"
                )
    scenarios: dict[str, str] = {}
    for part in parts:
        for name, sha256 in part.scenarios.items():
            if scenarios.setdefault(name, sha256) != sha256:
                raise ConfigurationError(
                    f"scenario {name!r} differs between these results; merge only parts of one "
                    "version of a suite"
                )
    seen: set[tuple[str, str]] = set()
    for part in parts:
        for run in part.runs:
            # Runs of an invalid scenario have no seed.
            which = f"repetition {run.repetition}" if run.seed is None else f"seed {run.seed}"
            if (run.scenario, which) in seen:
                raise ConfigurationError(
                    f"two of these results have a run of {run.scenario!r} with {which}; "
                    "name each file once"
                )
            seen.add((run.scenario, which))
    merged = replace(
        first,
        size=max(part.size for part in parts),
        scenarios=scenarios,
        shards=tuple(shard for part in parts for shard in part.shards),
        oracles=tuple(sorted({name for part in parts for name in part.oracles})),
        runs=(),
    )
    return merged.with_runs([run for part in parts for run in part.runs])
