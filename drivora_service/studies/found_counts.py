"""What a campaign found, and what its mutants changed, counted from its evaluations alone."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from drivora_service.oracles.verdict import Verdict
from drivora_service.oracles.verdicts.failure_definition import FailureDefinition
from drivora_service.store.campaigns.campaign_records import EvaluationRecord
from drivora_service.studies.situations import Situation, situation_of


@dataclass(slots=True, kw_only=True)
class Finds:
    """Failures as they were found.

    Attributes:
        kinds: Simulations up to the first of each kind.
        first_s: Seconds up to the first of all.
    """

    kinds: dict[str, int] = field(default_factory=dict)
    situations: set[Situation] = field(default_factory=set)
    first_s: float | None = None

    def add(self, kind: str, verdict: Verdict, simulation: int, elapsed_s: float) -> None:
        """Counts the next failure."""
        if not self.kinds:
            self.first_s = elapsed_s
        self.kinds.setdefault(kind, simulation)
        self.situations.add(situation_of(kind, verdict))

    @property
    def found(self) -> tuple[int, ...]:
        """For each kind, simulations up to its first failure, ascending."""
        return tuple(sorted(self.kinds.values()))

    @property
    def first(self) -> int | None:
        """Simulations up to the first failure."""
        return min(self.kinds.values(), default=None)


def uncounted_violations(
    verdicts: Iterable[Verdict], definition: FailureDefinition
) -> tuple[Verdict, ...]:
    """Returns the violations that a definition looks at and does not count."""
    return tuple(
        verdict
        for verdict in verdicts
        if definition.looks_at(verdict) and not definition.is_failure(verdict)
    )


def redrawn_share(records: Sequence[EvaluationRecord]) -> float | None:
    """Returns the share of mutants that were drawn again; see ``CampaignFigures``."""
    kept = sum(bool(record.proposal.parents) for record in records)
    redrawn = sum(record.proposal.redrawn for record in records)
    return redrawn / (kept + redrawn) if kept + redrawn else None


def unchanged_share(records: Sequence[EvaluationRecord]) -> float | None:
    """Returns the share of candidates with a parent's run; see ``CampaignFigures``."""
    runs = {record.number: record.report.egos_sha256 for record in records}
    compared = unchanged = 0
    for record in records:
        own = runs[record.number]
        parents = [runs[one] for one in record.proposal.parents if runs.get(one)]
        if own and parents:
            compared += 1
            unchanged += own in parents
    return unchanged / compared if compared else None
