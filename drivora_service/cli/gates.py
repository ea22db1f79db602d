"""What ``--gate`` fails on: which broken rules count, and in how many runs they may be broken."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from drivora_service.cli.results import accountability_of
from drivora_service.errors import ConfigurationError
from drivora_service.oracles.accountability import Accountability, accountability
from drivora_service.oracles.verdict import Severity, Verdict

ACCOUNTABLE = frozenset(
    {Accountability.AVOIDABLE, Accountability.NOT_MEASURABLE, Accountability.NOT_JUDGED}
)
"""What a gate counts: not what is another's fault, could not be avoided, or cannot be told."""

_RUNS = re.compile(r"[0-9]{1,9}")


@dataclass(frozen=True, slots=True, kw_only=True)
class Broken:
    """A broken rule as a gate looks at it."""

    rule: str
    is_observation: bool
    accountability: Accountability


@dataclass(frozen=True, slots=True, kw_only=True)
class GateAnswer:
    """What a gate says of runs.

    Attributes:
        fails: Whether some rule was broken in more runs than the gate allows.
        failing_runs: Runs in which a rule of the gate was broken.
        violations: How often.
        by_rule: Failing runs by rule.
        passed_over: Violations that do not count, since the ego is not accountable for them.
    """

    fails: bool
    failing_runs: int
    violations: int
    by_rule: Mapping[str, int]
    passed_over: int

    def __str__(self) -> str:
        """Says it in one line."""
        runs = f"{self.failing_runs} failing run{'' if self.failing_runs == 1 else 's'}"
        times = f"{self.violations} violation{'' if self.violations == 1 else 's'}"
        rules = ", ".join(f"{rule} in {count}" for rule, count in sorted(self.by_rule.items()))
        text = f"gate {'failed' if self.fails else 'passed'}: {runs}, {times}"
        if rules:
            text += f" ({rules})"
        if self.passed_over:
            text += f"; {self.passed_over} that the ego is not accountable for"
        return text


@dataclass(frozen=True, slots=True, kw_only=True)
class Gate:
    """Rules and the number of runs in which each may be broken.

    Attributes:
        allowed: Runs by rule; empty: every rule but observations, in none.
    """

    allowed: Mapping[str, int] = field(default_factory=dict)

    def judge(self, runs: Iterable[Sequence[Broken]]) -> GateAnswer:
        """Counts the runs in which rules of this gate were broken."""
        by_rule: Counter[str] = Counter()
        failing = violations = passed_over = 0
        for broken in runs:
            looked_at = [one for one in broken if self._looks_at(one)]
            counted = [one for one in looked_at if one.accountability in ACCOUNTABLE]
            by_rule.update({one.rule for one in counted})
            failing += bool(counted)
            violations += len(counted)
            passed_over += len(looked_at) - len(counted)
        return GateAnswer(
            fails=any(count > self.allowed.get(rule, 0) for rule, count in by_rule.items()),
            failing_runs=failing,
            violations=violations,
            by_rule=dict(by_rule),
            passed_over=passed_over,
        )

    def _looks_at(self, broken: Broken) -> bool:
        return broken.rule in self.allowed if self.allowed else not broken.is_observation


def read_gate(rules: Sequence[str], known: Collection[str], *, whose: str) -> Gate:
    """Reads ``RULE`` and ``RULE=RUNS``.

    Args:
        rules: As they were written.
        known: Names of the rules that runs are judged by.
        whose: Judges them by those, for the message.

    Raises:
        ConfigurationError: A rule is not among ``known``, or what it allows is no number.
    """
    allowed = {}
    for text in rules:
        rule, equals, runs = text.partition("=")
        if rule not in known:
            raise ConfigurationError(
                f"--gate-rule {text}: {whose} no rule {rule!r}; there are: {', '.join(known)}"
            )
        if equals and not _RUNS.fullmatch(runs):
            raise ConfigurationError(
                f"--gate-rule {rule}: {runs[:40]!r} is no number of runs; write it as {rule}=0"
            )
        allowed[rule] = int(runs or 0)
    return Gate(allowed=allowed)


def broken_in_result(violations: Iterable[Mapping[str, Any]]) -> list[Broken]:
    """Returns the broken rules of a printed result."""
    return [
        Broken(
            rule=verdict["oracle"],
            is_observation=verdict["severity"] == Severity.OBSERVATION,
            accountability=accountability_of(verdict),
        )
        for verdict in violations
    ]


def broken_in_campaign(violations: Iterable[tuple[int, Verdict]]) -> list[list[Broken]]:
    """Returns the broken rules by evaluation.

    What a campaign counts as a failure is no observation to its gate: the campaign has named it.
    """
    runs: dict[int, list[Broken]] = {}
    for number, verdict in violations:
        runs.setdefault(number, []).append(
            Broken(
                rule=verdict.oracle,
                is_observation=False,
                accountability=accountability(verdict),
            )
        )
    return list(runs.values())
