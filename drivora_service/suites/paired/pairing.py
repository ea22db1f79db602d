"""Pairs of runs of two batches that drive the same scenario with the same seed.

Two runs are a pair only if their scenarios are equal but for the agents, and their seeds are equal.
Labels decide first which of several equal runs belong together, and name the scenario: runs with
the same label are paired before others, so that the order of the batches does not matter.
"""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass
from enum import StrEnum

from drivora_service.suites.paired.paired_runs import PairedRun


class LeftOutReason(StrEnum):
    """Why runs are not compared."""

    ONLY_A = "only_a"
    """The other batch has no run of this scenario."""
    ONLY_B = "only_b"
    """The other batch has no run of this scenario."""
    SCENARIO_DIFFERS = "scenario_differs"
    """Both batches have a run of this label, but their scenarios differ in more than the agent."""
    SEED_DIFFERS = "seed_differs"
    """Both batches have a run of this scenario, but with other seeds."""
    NOT_ENDED = "not_ended"
    """A run of the pair waits or is running."""
    NOT_JUDGED = "not_judged"
    """A run of the pair ended without a judgement, and does not count as a failure."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Pair:
    """Runs of the same scenario and seed, one of each batch."""

    a: PairedRun
    b: PairedRun

    @property
    def scenario(self) -> str:
        """Name of the scenario: its label if either run has one."""
        return self.a.label or self.b.label or self.a.name

    @property
    def same_trace(self) -> bool:
        """Whether both runs recorded the same trace."""
        return bool(self.a.trace_sha256) and self.a.trace_sha256 == self.b.trace_sha256


@dataclass(frozen=True, slots=True, kw_only=True)
class Unpaired:
    """Runs without a counterpart: one run, or two of one label or scenario that differ."""

    reason: LeftOutReason
    a: PairedRun | None = None
    b: PairedRun | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Pairing:
    """Every run of two batches, each either in a pair or not."""

    pairs: tuple[Pair, ...]
    unpaired: tuple[Unpaired, ...]


_Key = Callable[[PairedRun], Hashable]


def pair_runs(first: Sequence[PairedRun], second: Sequence[PairedRun]) -> Pairing:
    """Pairs the runs of two batches; pairs are in the order of the first batch."""
    left_a, left_b = list(first), list(second)
    pairs: list[Pair] = []
    for key in (_label_and_content, _content_and_seed):
        found, left_a, left_b = _match_runs(key, left_a, left_b)
        pairs += [Pair(a=a, b=b) for a, b in found]
    place = {run.id: number for number, run in enumerate(first)}
    pairs.sort(key=lambda pair: place[pair.a.id])
    unpaired: list[Unpaired] = []
    same, left_a, left_b = _match_runs(_content, left_a, left_b)
    unpaired += [Unpaired(reason=LeftOutReason.SEED_DIFFERS, a=a, b=b) for a, b in same]
    named, left_a, left_b = _match_runs(_label, left_a, left_b)
    unpaired += [Unpaired(reason=LeftOutReason.SCENARIO_DIFFERS, a=a, b=b) for a, b in named]
    unpaired += [Unpaired(reason=LeftOutReason.ONLY_A, a=run) for run in left_a]
    unpaired += [Unpaired(reason=LeftOutReason.ONLY_B, b=run) for run in left_b]
    return Pairing(pairs=tuple(pairs), unpaired=tuple(unpaired))


def _label_and_content(run: PairedRun) -> Hashable:
    return run.label, run.scenario.content, run.seed


def _content_and_seed(run: PairedRun) -> Hashable:
    return run.scenario.content, run.seed


def _content(run: PairedRun) -> Hashable:
    return run.scenario.content


def _label(run: PairedRun) -> Hashable:
    # Runs without a label have no name in common.
    return run.label or run.id


def _match_runs(
    key: _Key, first: Sequence[PairedRun], second: Sequence[PairedRun]
) -> tuple[list[tuple[PairedRun, PairedRun]], list[PairedRun], list[PairedRun]]:
    """Matches runs of the same key in their order; returns those that remain in their order."""
    counterparts: dict[Hashable, deque[PairedRun]] = defaultdict(deque)
    for run in second:
        counterparts[key(run)].append(run)
    matched: list[tuple[PairedRun, PairedRun]] = []
    left: list[PairedRun] = []
    for run in first:
        if waiting := counterparts.get(key(run)):
            matched.append((run, waiting.popleft()))
        else:
            left.append(run)
    taken = {b.id for _, b in matched}
    return matched, left, [run for run in second if run.id not in taken]
