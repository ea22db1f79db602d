"""Figures of a campaign, by which campaigns are compared."""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pydantic import computed_field

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.oracles.verdicts.accountability import (
    Accountability,
    accountability,
    strongest,
)
from drivora_service.oracles.verdicts.failure_definition import FailureDefinition
from drivora_service.search.genes import GeneSpace
from drivora_service.search.tester import EvaluationStatus
from drivora_service.shapes import Shape
from drivora_service.store.campaigns.campaign_records import EvaluationRecord
from drivora_service.studies.coverage.law_coverage import law_coverage
from drivora_service.studies.found_counts import (
    Finds,
    redrawn_share,
    unchanged_share,
    uncounted_violations,
)

_LEVELS = 4
"""Number of levels of a gene's range for counting tried combinations."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CampaignFigures(Shape):
    """One campaign in figures.

    Attributes:
        campaign: Id of the campaign.
        method: What is compared: campaigns of one method are repetitions of one another.
        scenario: Name of the seed scenario; only campaigns of the same one are compared.
        seed: Seed of the search.
        simulations: Number of simulated candidates.
        invalid_share: Share of invalid candidates among all.
        failed_share: Share of simulations without a result.
        failing: Simulations with at least one failure.
        at_fault: Simulations in which an ego is known to be responsible for one.
        avoidable: Those of them with one that a careful and competent driver avoids: the target.
        not_measurable: Simulations without such a one, but with a violation at fault of which the
            run does not tell whether that driver avoids it. This and the next five count violations
            of the campaign's oracles, whether they are failures or not, by their strongest.
        unavoidable: Simulations with violations at fault in which that driver avoids none.
        undetermined: Simulations in which the fault of no violation can be determined.
        not_judged: Simulations with violations of oracles alone that do not attribute fault.
        preventable: Simulations with violations at the fault of others alone, one that a careful
            and competent driver of the ego avoids.
        not_at_fault: Simulations with violations at the fault of others alone, avoided or not.
        kinds: Kinds of failures: oracle, place, relation of the other actor to the ego.
        avoidable_kinds: Kinds of those failures that are the fault of an ego and avoidable.
        oracles: Different oracles violated; collisions count by the other actor: an ego, an NPC
            vehicle, background traffic, a walker or an obstacle.
        groups: Groups of similar failures among its own; ``None`` if they were not grouped.
        situations: Situations in which failures occurred (``studies.situations``).
        avoidable_situations: Situations of failures that are the fault of an ego and avoidable.
        first_failure: Simulations up to the first failure, itself included; ``None``: none found.
        first_avoidable: The same up to the first one that is the fault of an ego and avoidable.
        found: For each different failure, simulations up to it, ascending.
        found_avoidable: The same for those that are the fault of an ego and avoidable.
        gene_coverage: Share of all combinations of two genes' levels that were tried; with several
            seed scenarios the mean of theirs.
        simulation_s: Seconds of all runs in their workers.
        own_s: Seconds of the method itself: asking, telling, repairing, decoding, checking.
        network_coverage: Share of the network's drivable lanes, by length, on which actors were
            placed or planned; ``None``: not known.
        law_coverage: Share of the ways to violate the traffic laws that judged its runs which some
            run showed; ``None``: no law judged them.
        first_failure_s: Seconds of one worker up to the first failure, the method's own included;
            ``None``: none found.
        first_avoidable_s: The same up to the first one that is the fault of an ego and avoidable.
        redrawn_share: Mutants that were drawn again, as they could not change the run of any ego,
            over these and all candidates with a parent; ``None`` without any.
        unchanged_share: Simulated candidates with the run of a parent, as far as the egos are
            concerned, over all with a parent; ``None``: without any, or not recorded.
        time_limit_s: Seconds after which evaluations were left out, for a comparison at equal time;
            ``None``: none were.
        budget: Simulations that it could make; ``None``: those that it made.
    """

    campaign: str
    method: str
    scenario: str
    seed: int
    simulations: int
    invalid_share: float
    failed_share: float
    failing: int
    at_fault: int
    avoidable: int
    not_measurable: int
    unavoidable: int
    undetermined: int
    not_judged: int
    preventable: int
    not_at_fault: int
    kinds: int
    avoidable_kinds: int
    oracles: int
    groups: int | None
    situations: int
    avoidable_situations: int
    first_failure: int | None
    first_avoidable: int | None
    found: tuple[int, ...]
    found_avoidable: tuple[int, ...]
    gene_coverage: float
    simulation_s: float
    own_s: float
    network_coverage: float | None = None
    law_coverage: float | None = None
    first_failure_s: float | None = None
    first_avoidable_s: float | None = None
    redrawn_share: float | None = None
    unchanged_share: float | None = None
    time_limit_s: float | None = None
    budget: int | None = None

    @computed_field  # type: ignore[prop-decorator] # as pydantic documents it
    @property
    def own_share(self) -> float:
        """The method's own time over that of the runs."""
        return self.own_s / self.simulation_s if self.simulation_s > 0.0 else 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Subject:
    """The campaign of some figures; see :class:`CampaignFigures`."""

    campaign: str
    method: str
    scenario: str
    seed: int


def figures_of(
    subject: Subject,
    records: Sequence[EvaluationRecord],
    spaces: Sequence[GeneSpace],
    *,
    definition: FailureDefinition,
    groups: int | None = None,
    network_coverage: float | None = None,
    time_limit_s: float | None = None,
    budget: int | None = None,
) -> CampaignFigures:
    """Computes the figures of a campaign.

    Args:
        subject: The campaign.
        records: Its evaluations in order.
        spaces: Its genes, by seed scenario.
        definition: What the campaign counts as a failure.
        groups: Groups of similar failures, if known.
        network_coverage: See :class:`CampaignFigures`.
        time_limit_s: Seconds of wall time of one worker after which evaluations do not count;
            ``None``: all count.
        budget: Simulations that it may make.
    """
    if time_limit_s is not None:
        records = within_time(records, time_limit_s)
    simulated = [r for r in records if r.status is not EvaluationStatus.INVALID]
    finds, targets = Finds(), Finds()
    violated: set[tuple[str, str]] = set()
    failing = at_fault = 0
    accountable = Counter[Accountability | None]()
    count, elapsed_s = 0, 0.0
    for record in records:
        elapsed_s += cost_s(record)
        count += record.status is not EvaluationStatus.INVALID
        uncounted = uncounted_violations(record.report.verdicts, definition)
        accountable[strongest((*record.violations, *uncounted))] += 1
        if not record.violations:
            continue
        failing += 1
        at_fault += record.at_fault
        for kind, verdict in zip(record.failure_kinds, record.violations, strict=True):
            finds.add(kind, verdict, count, elapsed_s)
            if accountability(verdict) is Accountability.AVOIDABLE:
                targets.add(kind, verdict, count, elapsed_s)
            # By its part: an actor of the seed scenario may be called anything.
            violated.add((verdict.oracle, str(verdict.evidence.get("counterpart_role", ""))))
    failed = sum(r.status is EvaluationStatus.FAILED for r in simulated)
    return CampaignFigures(
        campaign=subject.campaign,
        method=subject.method,
        scenario=subject.scenario,
        seed=subject.seed,
        simulations=len(simulated),
        invalid_share=_share(len(records) - len(simulated), len(records)),
        failed_share=_share(failed, len(simulated)),
        failing=failing,
        at_fault=at_fault,
        avoidable=accountable[Accountability.AVOIDABLE],
        not_measurable=accountable[Accountability.NOT_MEASURABLE],
        unavoidable=accountable[Accountability.UNAVOIDABLE],
        undetermined=accountable[Accountability.UNDETERMINED],
        not_judged=accountable[Accountability.NOT_JUDGED],
        preventable=accountable[Accountability.PREVENTABLE],
        not_at_fault=(
            accountable[Accountability.PREVENTABLE] + accountable[Accountability.NOT_AT_FAULT]
        ),
        kinds=len(finds.kinds),
        avoidable_kinds=len(targets.kinds),
        oracles=len(violated),
        groups=groups,
        situations=len(finds.situations),
        avoidable_situations=len(targets.situations),
        first_failure=finds.first,
        first_avoidable=targets.first,
        found=finds.found,
        found_avoidable=targets.found,
        gene_coverage=_mean_coverage(simulated, spaces),
        simulation_s=sum(r.report.wall_time_s for r in simulated),
        own_s=sum(r.search_s + r.prepare_s for r in records),
        network_coverage=network_coverage,
        law_coverage=law_coverage(v for r in simulated for v in r.report.verdicts),
        first_failure_s=finds.first_s,
        first_avoidable_s=targets.first_s,
        redrawn_share=redrawn_share(records),
        unchanged_share=unchanged_share(records),
        time_limit_s=time_limit_s,
        budget=budget,
    )


def _mean_coverage(records: Sequence[EvaluationRecord], spaces: Sequence[GeneSpace]) -> float:
    shares = []
    for number, space in enumerate(spaces):
        rows = [r.proposal.values for r in records if r.seed_number == number]
        shares.append(pairwise_coverage(np.array(rows).reshape(len(rows), len(space)), space))
    return sum(shares) / len(shares)


def cost_s(record: EvaluationRecord) -> float:
    """Returns the seconds of one worker for an evaluation, the method's own included."""
    return record.report.wall_time_s + record.search_s + record.prepare_s


def duration_s(records: Sequence[EvaluationRecord]) -> float:
    """Returns the seconds that one worker would have taken for all evaluations."""
    # Summed as in `within_time`: a limit from here leaves nothing out.
    return max(itertools.accumulate(map(cost_s, records)), default=0.0)


def within_time(records: Sequence[EvaluationRecord], seconds: float) -> list[EvaluationRecord]:
    """Returns the evaluations that one worker completes within some seconds of wall time.

    The method's own time counts, so that methods can be compared at equal time.
    """
    ends = itertools.accumulate(map(cost_s, records))
    return [record for record, end in zip(records, ends, strict=True) if end <= seconds]


def pairwise_coverage(values: FloatArray, space: GeneSpace) -> float:
    """Returns the share of two-way combinations that were tried.

    Every range is cut into four equal levels (fewer where a whole gene has fewer values). Of all
    pairs of genes that vary, and all combinations of their levels, it counts those that some
    candidate has, as combinatorial testing does.

    Args:
        values: (n, d) candidates.
        space: Their genes.
    """
    varying = np.flatnonzero(space.varies)
    if len(varying) < 2 or not len(values):
        return 0.0
    unit = space.to_unit(values)[:, varying]
    counts = np.where(space.is_whole, space.highs - space.lows + 1.0, float(_LEVELS))[varying]
    levels = np.minimum(counts, _LEVELS).astype(np.int64)
    cells = np.minimum((unit * levels).astype(np.int64), levels - 1)
    # One column for each level of each gene: two columns that are both set in a row are a pair.
    starts = np.concatenate(([0], np.cumsum(levels)))
    marks = np.zeros((len(cells), int(starts[-1])), dtype=np.float32)
    rows = np.arange(len(cells))[:, None]
    marks[rows, cells + starts[:-1]] = 1.0
    together = (marks.T @ marks) > 0.5
    tried = int(np.triu(together, 1).sum())
    possible = int((levels.sum() ** 2 - (levels**2).sum()) // 2)
    return tried / possible


def _share(part: int, whole: int) -> float:
    return part / whole if whole else 0.0
