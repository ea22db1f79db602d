"""Gates: the oracles that count, and the number of runs that may violate each."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import typer

from drivora_service.cli.exit_codes import ExitCode
from drivora_service.cli.terminal.output import note
from drivora_service.errors import ConfigurationError
from drivora_service.known_names import advise_name
from drivora_service.oracles.verdict import Verdict
from drivora_service.oracles.verdicts.accountability import Accountability, accountability
from drivora_service.oracles.verdicts.failure_definition import (
    DEFAULT_DEFINITION,
    Counted,
    FailureDefinition,
    requested_definition,
    state_definition,
)
from drivora_service.runs.run_report import RunStatus

_RUNS = re.compile(r"[0-9]{1,9}")
_MOST_NAMED = 20
"""Runs in which the ADS failed that are named."""


@dataclass(frozen=True, slots=True, kw_only=True)
class GateAnswer:
    """The result of a gate.

    Attributes:
        fails: Whether some oracle was violated in more runs than the gate allows, or the ADS itself
            failed in a run.
        failing_runs: Runs in which an oracle of the gate was violated, or the ADS itself failed.
        violations: How often oracles of the gate were violated.
        by_oracle: Failing runs by oracle, and by ``agent_failed``.
        passed_over: Violations that do not count, for the accountability of the ego.
        preventable: Those of them at the fault of others that a careful driver avoids.
        agent_failed: Names of the runs in which the ADS itself failed.
        definition: What counts, in words.
    """

    fails: bool
    failing_runs: int
    violations: int
    by_oracle: Mapping[str, int]
    passed_over: int
    preventable: int
    agent_failed: tuple[str, ...]
    definition: str

    def __str__(self) -> str:
        """Returns it in one line."""
        runs = f"{self.failing_runs} failing run{'' if self.failing_runs == 1 else 's'}"
        times = f"{self.violations} violation{'' if self.violations == 1 else 's'}"
        oracles = ", ".join(f"{name} in {count}" for name, count in sorted(self.by_oracle.items()))
        text = f"gate {'failed' if self.fails else 'passed'}: {runs}, {times}"
        if oracles:
            text += f" ({oracles})"
        if self.passed_over:
            text += f"; {self.passed_over} that do not count"
            if self.preventable:
                text += f" ({self.preventable} not at fault, but avoidable)"
        return text

    def lines(self) -> tuple[str, ...]:
        """Returns it as it is printed: also the runs in which the ADS failed, and what counts."""
        lines = [str(self)]
        if self.agent_failed:
            names = ", ".join(self.agent_failed[:_MOST_NAMED])
            more = len(self.agent_failed) - _MOST_NAMED
            lines.append(f"the ADS failed in {names}{f' and {more} more' if more > 0 else ''}")
        return (*lines, f"Failures are {self.definition}")


@dataclass(frozen=True, slots=True, kw_only=True)
class Gate:
    """Oracles and the number of runs in which each may be violated.

    Attributes:
        definition: What counts as a failure of a run.
        allowed: Runs by oracle; empty: in none.
    """

    definition: FailureDefinition = DEFAULT_DEFINITION
    allowed: Mapping[str, int] = field(default_factory=dict)

    def judge(
        self, runs: Iterable[Collection[Verdict]], *, agent_failed: Sequence[str] = ()
    ) -> GateAnswer:
        """Counts the runs with failures.

        Args:
            runs: The violations of each run that was judged.
            agent_failed: Names of the runs in which the ADS itself failed. Each is a failing run,
                whichever oracles count.
        """
        by_oracle: Counter[str] = Counter()
        if agent_failed:
            by_oracle[RunStatus.AGENT_FAILED.value] = len(agent_failed)
        failing = len(agent_failed)
        violations = passed_over = preventable = 0
        for violated in runs:
            looked_at = [one for one in violated if self.definition.looks_at(one)]
            counted = [one for one in looked_at if self.definition.is_failure(one)]
            by_oracle.update({one.oracle for one in counted})
            failing += bool(counted)
            violations += len(counted)
            passed_over += len(looked_at) - len(counted)
            preventable += sum(
                accountability(one) is Accountability.PREVENTABLE
                for one in looked_at
                if not self.definition.is_failure(one)
            )
        return GateAnswer(
            fails=any(count > self.allowed.get(name, 0) for name, count in by_oracle.items()),
            failing_runs=failing,
            violations=violations,
            by_oracle=dict(by_oracle),
            passed_over=passed_over,
            preventable=preventable,
            agent_failed=tuple(agent_failed),
            definition=state_definition((self.definition,)).words,
        )


def read_gate(
    wanted: Sequence[str],
    known: Collection[str],
    *,
    counted_by: str,
    counts: Counted | None = None,
) -> Gate:
    """Reads ``ORACLE`` and ``ORACLE=RUNS``.

    Args:
        wanted: Texts of the command line.
        known: Names of the oracles that runs are judged by.
        counted_by: Owner of the oracles, for the message.
        counts: The violations that are failures; ``None``: the default.

    Raises:
        ConfigurationError: An oracle is not among ``known``, or what it allows is no number.
    """
    allowed = {}
    for text in wanted:
        name, equals, runs = text.partition("=")
        if name not in known:
            raise ConfigurationError(
                f"--gate-oracle {text}: {counted_by} has no oracle {name!r}; "
                f"{advise_name(name, known)}"
            )
        if equals and not _RUNS.fullmatch(runs):
            raise ConfigurationError(
                f"--gate-oracle {name}: {runs[:40]!r} is no number of runs; write it as {name}=0"
            )
        allowed[name] = int(runs or 0)
    definition = requested_definition(counts, allowed) or DEFAULT_DEFINITION
    return Gate(definition=definition, allowed=allowed)


def print_answer(answer: GateAnswer) -> None:
    """Prints the result of a gate on standard error, and exits with 1 if it fails."""
    for line in answer.lines():
        note(line)
    if answer.fails:
        raise typer.Exit(ExitCode.GATE_FAILED)


def group_by_evaluation(violated: Iterable[tuple[int, Verdict]]) -> list[list[Verdict]]:
    """Returns the failures of a campaign by evaluation."""
    runs: dict[int, list[Verdict]] = {}
    for number, verdict in violated:
        runs.setdefault(number, []).append(verdict)
    return list(runs.values())
