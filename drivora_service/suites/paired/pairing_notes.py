"""Remarks on a comparison of two batches: what is not compared, and what limits it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence

from drivora_service.suites.paired.batch_comparison import LeftOut, SettingDifference
from drivora_service.suites.paired.failure_counts import JudgedPair
from drivora_service.suites.paired.pairing import LeftOutReason

_FEW = 20
"""Scenarios below which intervals are known to be too narrow."""

_REASONS = {
    LeftOutReason.ONLY_A: "only A has a run of the scenario",
    LeftOutReason.ONLY_B: "only B has a run of the scenario",
    LeftOutReason.SCENARIO_DIFFERS: "the scenarios of one label differ in more than the agent",
    LeftOutReason.SEED_DIFFERS: "the seeds differ",
    LeftOutReason.NOT_ENDED: "a run has not ended",
    LeftOutReason.NOT_JUDGED: "a run ended without a judgement",
}


def notes(
    scenarios: Mapping[str, Sequence[JudgedPair]],
    left_out: Sequence[LeftOut],
    differences: Sequence[SettingDifference],
    *,
    has_runs: bool,
) -> Iterator[str]:
    """Yields the remarks on a comparison.

    Args:
        scenarios: Compared pairs by the content of their scenario.
        left_out: Runs that are not compared.
        differences: In what the batches differ.
        has_runs: Whether both batches have runs.
    """
    if left_out:
        counts = Counter(one.reason for one in left_out)
        told = [f"{counts[reason]}: {_REASONS[reason]}" for reason in _REASONS if counts[reason]]
        why = f": {_REASONS[left_out[0].reason]}" if len(told) == 1 else f" ({'; '.join(told)})"
        yield f"{len(left_out)} left out{why}"
    if has_runs and not differences:
        yield "the batches do not differ in agents, parameters or versions"
    pairs = [pair for one in scenarios.values() for pair in one]
    if any(len(one) > 1 for one in scenarios.values()):
        yield (
            f"{len(pairs)} pairs of {len(scenarios)} scenarios: a scenario counts once, for the "
            "one of A and B that fails in more of its pairs"
        )
    same = sum(pair.pair.same_trace for pair in pairs)
    if same:
        yield f"in {same} of {len(pairs)} pairs both runs are the same, step by step"
    if 0 < len(scenarios) < _FEW:
        yield (
            f"intervals of so few scenarios ({len(scenarios)}) are too narrow; compare on {_FEW} "
            "or more"
        )
