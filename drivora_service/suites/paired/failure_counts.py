"""Failures of pairs, counted over scenarios.

The unit is the scenario: runs of one scenario with several seeds are not independent. A scenario
tells A from B if one of them fails in more of its pairs than the other; with one pair a scenario
this is McNemar's test of pairs, with several it is the sign test of scenarios.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from drivora_service.runs.run_report import RunStatus
from drivora_service.studies.comparison.sample_statistics import holm
from drivora_service.suites.paired.batch_comparison import (
    SIGNIFICANT,
    FailureComparison,
    PairedJudgement,
    WhichFails,
)
from drivora_service.suites.paired.failure_rules import Judged
from drivora_service.suites.paired.mcnemar import compare_shares
from drivora_service.suites.paired.pairing import Pair

_STATUSES = frozenset(map(str, RunStatus))


@dataclass(frozen=True, slots=True, kw_only=True)
class JudgedPair:
    """A pair whose runs both count."""

    pair: Pair
    a: Judged
    b: Judged

    @property
    def fails(self) -> WhichFails:
        """Which of A and B fails."""
        return which_fails(bool(self.a.failures), bool(self.b.failures))


Scenarios = Mapping[str, Sequence[JudgedPair]]
"""Pairs by the content of their scenario."""


def which_fails(failing_a: int, failing_b: int) -> WhichFails:
    """Returns which of A and B fails more often."""
    if failing_a == failing_b:
        return WhichFails.BOTH if failing_a else WhichFails.NEITHER
    return WhichFails.A_ONLY if failing_a > failing_b else WhichFails.B_ONLY


def scenario_fails(pairs: Sequence[JudgedPair]) -> WhichFails:
    """Returns which of A and B fails in more pairs of a scenario."""
    return which_fails(
        sum(bool(p.a.failures) for p in pairs), sum(bool(p.b.failures) for p in pairs)
    )


def compare_failures(scenarios: Scenarios) -> FailureComparison:
    """Compares in how many scenarios A and B fail, whatever the oracle."""
    counts = Counter(scenario_fails(pairs) for pairs in scenarios.values())
    every = [pair for pairs in scenarios.values() for pair in pairs]
    return _comparison(
        "",
        counts,
        runs_a=sum(bool(pair.a.failures) for pair in every),
        runs_b=sum(bool(pair.b.failures) for pair in every),
        not_measurable=0,
        not_counted=0,
    )


def compare_oracles(scenarios: Scenarios) -> tuple[FailureComparison, ...]:
    """Compares the failures by each oracle that has one, the most frequent first."""
    every = [pair for pairs in scenarios.values() for pair in pairs]
    frequent = Counter(name for pair in every for one in (pair.a, pair.b) for name in one.failures)
    found = [
        _by_oracle(scenarios, name)
        for name, _ in sorted(frequent.items(), key=lambda item: (-item[1], item[0]))
    ]
    corrected = holm([one.p for one in found])
    return tuple(_add_judgement(one, p) for one, p in zip(found, corrected, strict=True))


def _by_oracle(scenarios: Scenarios, oracle: str) -> FailureComparison:
    counts: Counter[WhichFails] = Counter()
    runs_a = runs_b = not_measurable = not_counted = 0
    for pairs in scenarios.values():
        counted = [p for p in pairs if _is_counted(p.a, oracle) and _is_counted(p.b, oracle)]
        known = [p for p in counted if _is_measured(p.a, oracle) and _is_measured(p.b, oracle)]
        not_counted += len(pairs) - len(counted)
        not_measurable += len(counted) - len(known)
        if not known:
            continue
        a = sum(oracle in pair.a.failures for pair in known)
        b = sum(oracle in pair.b.failures for pair in known)
        counts[which_fails(a, b)] += 1
        runs_a, runs_b = runs_a + a, runs_b + b
    return _comparison(
        oracle,
        counts,
        runs_a=runs_a,
        runs_b=runs_b,
        not_measurable=not_measurable,
        not_counted=not_counted,
    )


def _is_counted(judged: Judged, oracle: str) -> bool:
    """Whether the definition of a run looks at an oracle."""
    return oracle in _STATUSES or judged.named is None or oracle in judged.named


def _is_measured(judged: Judged, oracle: str) -> bool:
    """Whether it is known if a run failed by an oracle."""
    if oracle in _STATUSES or oracle in judged.failures:
        return True
    return oracle in judged.oracles and oracle not in judged.not_measurable


def _comparison(
    oracle: str,
    counts: Mapping[WhichFails, int],
    *,
    runs_a: int,
    runs_b: int,
    not_measurable: int,
    not_counted: int,
) -> FailureComparison:
    a_only, b_only = counts.get(WhichFails.A_ONLY, 0), counts.get(WhichFails.B_ONLY, 0)
    shares = compare_shares(a_only=a_only, b_only=b_only, scenarios=sum(counts.values()))
    p = 1.0 if shares is None else shares.p
    compared = FailureComparison(
        oracle=oracle,
        a_only=a_only,
        b_only=b_only,
        both=counts.get(WhichFails.BOTH, 0),
        neither=counts.get(WhichFails.NEITHER, 0),
        not_measurable=not_measurable,
        not_counted=not_counted,
        runs_a=runs_a,
        runs_b=runs_b,
        difference=None if shares is None else shares.difference,
        low=None if shares is None else shares.low,
        high=None if shares is None else shares.high,
        p=p,
        p_holm=p,
        judgement=PairedJudgement.UNDECIDED,
    )
    return _add_judgement(compared, p)


def _add_judgement(compared: FailureComparison, p_holm: float) -> FailureComparison:
    judgement = PairedJudgement.UNDECIDED
    if p_holm < SIGNIFICANT:
        fewer = compared.b_only < compared.a_only
        judgement = PairedJudgement.BETTER if fewer else PairedJudgement.WORSE
    return replace(compared, p_holm=p_holm, judgement=judgement)
