"""Gates: the oracles that count, and the number of runs that may violate each."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from drivora_service.errors import ConfigurationError
from drivora_service.oracles.verdict import Severity, Verdict
from drivora_service.oracles.verdicts.accountability import (
    ACCOUNTABLE,
    Accountability,
    accountability,
)
from drivora_service.oracles.verdicts.failure_facts import is_consequence

_RUNS = re.compile(r"[0-9]{1,9}")


@dataclass(frozen=True, slots=True, kw_only=True)
class Violation:
    """A violated oracle as a gate counts it.

    Attributes:
        is_observation: It counts only where its oracle is named: it is an observation, or follows
            from a violation that counts.
    """

    oracle: str
    is_observation: bool
    accountability: Accountability


@dataclass(frozen=True, slots=True, kw_only=True)
class GateAnswer:
    """The result of a gate.

    Attributes:
        fails: Whether some oracle was violated in more runs than the gate allows.
        failing_runs: Runs in which an oracle of the gate was violated.
        violations: How often.
        by_oracle: Failing runs by oracle.
        passed_over: Violations that do not count, since the ego is not accountable for them.
    """

    fails: bool
    failing_runs: int
    violations: int
    by_oracle: Mapping[str, int]
    passed_over: int

    def __str__(self) -> str:
        """Returns it in one line."""
        runs = f"{self.failing_runs} failing run{'' if self.failing_runs == 1 else 's'}"
        times = f"{self.violations} violation{'' if self.violations == 1 else 's'}"
        oracles = ", ".join(f"{name} in {count}" for name, count in sorted(self.by_oracle.items()))
        text = f"gate {'failed' if self.fails else 'passed'}: {runs}, {times}"
        if oracles:
            text += f" ({oracles})"
        if self.passed_over:
            text += f"; {self.passed_over} that the ego is not accountable for"
        return text


@dataclass(frozen=True, slots=True, kw_only=True)
class Gate:
    """Oracles and the number of runs in which each may be violated.

    Attributes:
        allowed: Runs by oracle; empty: every oracle but observations, in none.
    """

    allowed: Mapping[str, int] = field(default_factory=dict)

    def judge(self, runs: Iterable[Sequence[Violation]]) -> GateAnswer:
        """Counts the runs in which oracles of this gate were violated."""
        by_oracle: Counter[str] = Counter()
        failing = violations = passed_over = 0
        for violated in runs:
            looked_at = [one for one in violated if self._looks_at(one)]
            counted = [one for one in looked_at if one.accountability in ACCOUNTABLE]
            by_oracle.update({one.oracle for one in counted})
            failing += bool(counted)
            violations += len(counted)
            passed_over += len(looked_at) - len(counted)
        return GateAnswer(
            fails=any(count > self.allowed.get(name, 0) for name, count in by_oracle.items()),
            failing_runs=failing,
            violations=violations,
            by_oracle=dict(by_oracle),
            passed_over=passed_over,
        )

    def _looks_at(self, violation: Violation) -> bool:
        return violation.oracle in self.allowed if self.allowed else not violation.is_observation


def read_gate(wanted: Sequence[str], known: Collection[str], *, counted_by: str) -> Gate:
    """Reads ``ORACLE`` and ``ORACLE=RUNS``.

    Args:
        wanted: Texts of the command line.
        known: Names of the oracles that runs are judged by.
        counted_by: Owner of the oracles, for the message.

    Raises:
        ConfigurationError: An oracle is not among ``known``, or what it allows is no number.
    """
    allowed = {}
    for text in wanted:
        name, equals, runs = text.partition("=")
        if name not in known:
            raise ConfigurationError(
                f"--gate-oracle {text}: {counted_by} has no oracle {name!r}; known: "
                f"{', '.join(known)}"
            )
        if equals and not _RUNS.fullmatch(runs):
            raise ConfigurationError(
                f"--gate-oracle {name}: {runs[:40]!r} is no number of runs; write it as {name}=0"
            )
        allowed[name] = int(runs or 0)
    return Gate(allowed=allowed)


def violations_of_run(violated: Iterable[Verdict]) -> list[Violation]:
    """Returns the violations of a run."""
    return [
        Violation(
            oracle=verdict.oracle,
            is_observation=verdict.severity is Severity.OBSERVATION or is_consequence(verdict),
            accountability=accountability(verdict),
        )
        for verdict in violated
    ]


def violations_of_campaign(violated: Iterable[tuple[int, Verdict]]) -> list[list[Violation]]:
    """Returns the violations by evaluation.

    A violation that a campaign counts as a failure is not an observation: the campaign names it.
    """
    runs: dict[int, list[Violation]] = {}
    for number, verdict in violated:
        runs.setdefault(number, []).append(
            Violation(
                oracle=verdict.oracle,
                is_observation=False,
                accountability=accountability(verdict),
            )
        )
    return list(runs.values())
