"""What counts as a failure of a run."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from enum import StrEnum

from drivora_service.oracles.verdict import Outcome, Verdict
from drivora_service.oracles.verdicts.failure_definition import FailureDefinition
from drivora_service.oracles.verdicts.failure_facts import failure_sentence
from drivora_service.runs.run_report import RunStatus
from drivora_service.shapes import Shape
from drivora_service.suites.paired.paired_runs import PairedRun


class Unfinished(StrEnum):
    """The runs without a judgement that are failures."""

    AGENT = "agent"
    """Those that the ADS ended: it raised, hung, died or answered invalidly."""
    ALL = "all"
    """Those that ended without a judgement for any reason but a cancellation or an invalid
    scenario."""
    NONE = "none"
    """None of them."""


_ENDED_BY_FAULTS = frozenset(
    {
        RunStatus.AGENT_FAILED,
        RunStatus.PLUGIN_FAILED,
        RunStatus.SIMULATOR_CRASHED,
        RunStatus.TIMED_OUT,
        RunStatus.INFRASTRUCTURE_FAILED,
    }
)
_COUNTED: Mapping[Unfinished, frozenset[RunStatus]] = {
    Unfinished.AGENT: frozenset({RunStatus.AGENT_FAILED}),
    Unfinished.ALL: _ENDED_BY_FAULTS,
    Unfinished.NONE: frozenset(),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class FailureFound(Shape):
    """A failure of a run.

    Attributes:
        oracle: The violated oracle; of a run without a judgement, its status.
        sentence: Facts of the first violation.
        time: Simulation time in seconds at which it began; null if there is none.
        violations: How often the oracle was violated.
    """

    oracle: str
    sentence: str
    time: float | None = None
    violations: int = 1


@dataclass(frozen=True, slots=True, kw_only=True)
class Judged:
    """A run under the rules of a comparison.

    Attributes:
        failures: By oracle.
        not_measurable: Oracles that could not be judged; they are not failures.
        oracles: Oracles with a verdict.
        named: The only oracles that the definition counts; ``None``: all but observations.
        is_preventable: Whether a violation is not the fault of the ego, but avoidable, counted or
            not.
    """

    failures: Mapping[str, FailureFound]
    not_measurable: frozenset[str]
    oracles: frozenset[str]
    named: frozenset[str] | None = None
    is_preventable: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Rules:
    """What counts as a failure in a comparison.

    Attributes:
        definition: The violations that count in every run; ``None``: what was defined for each run
            when it was posted, unless oracles are asked for.
        oracles: Without a definition: the only oracles that count, by `counts` of the runs. A
            comparison makes a definition of it; empty: not asked for.
        unfinished: The runs without a judgement that count, unless oracles are named.
    """

    definition: FailureDefinition | None = None
    oracles: tuple[str, ...] = ()
    unfinished: Unfinished = Unfinished.AGENT

    def definition_of(self, run: PairedRun) -> FailureDefinition:
        """Returns what counts in a run."""
        return run.definition if self.definition is None else self.definition

    def judge(self, run: PairedRun) -> Judged | None:
        """Returns the failures of a run; ``None`` if it has no result that counts."""
        definition = self.definition_of(run)
        named = None if definition.oracles is None else frozenset(definition.oracles)
        agents = {ego: choice.name for ego, choice in run.agents.items()} or {"": run.agent}
        if run.status is not RunStatus.FINISHED:
            # Who asks for some oracles does not ask for these; a suite names oracles of its runs.
            asked = self.definition is not None and self.definition.oracles is not None
            if asked or run.status not in _COUNTED[self.unfinished]:
                return None
            status = str(run.status)
            found = FailureFound(oracle=status, sentence=_describe_ending(run))
            failures = {} if definition.knows(status, "", "", agents) else {status: found}
            return Judged(
                failures=failures, not_measurable=frozenset(), oracles=frozenset(), named=named
            )
        failing: dict[str, list[Verdict]] = {}
        for verdict in definition.failures(run.verdicts, agents):
            failing.setdefault(verdict.oracle, []).append(verdict)
        unknown = {
            verdict.oracle
            for verdict in run.verdicts
            if verdict.outcome is Outcome.NOT_MEASURABLE
            and (named is None or verdict.oracle in named)
        }
        return Judged(
            failures={oracle: _make_failure_found(found, run) for oracle, found in failing.items()},
            not_measurable=frozenset(unknown - failing.keys()),
            oracles=run.oracles if named is None else run.oracles & named,
            named=named,
            is_preventable=definition.is_preventable(run.verdicts),
        )


def _make_failure_found(verdicts: Collection[Verdict], run: PairedRun) -> FailureFound:
    first = min(verdicts, key=lambda verdict: (verdict.time is None, verdict.time or 0.0))
    return FailureFound(
        oracle=first.oracle,
        sentence=failure_sentence(first, town=run.scenario.town),
        time=first.time,
        violations=len(verdicts),
    )


def _describe_ending(run: PairedRun) -> str:
    cause = f": {run.cause.replace('_', ' ')}" if run.cause else ""
    return f"The run ended without a judgement{cause}."
