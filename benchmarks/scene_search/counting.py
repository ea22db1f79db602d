"""Random draws from the space of a scene, and how often its ADS fails in them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.search_scenes import Scene, prepare_scene
from drivora_service.campaigns.evaluator import Evaluator
from drivora_service.campaigns.search.evaluation_judging import violations_of
from drivora_service.campaigns.search.seed_turns import SearchPart
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.oracles.verdicts.accountability import AT_FAULT, Accountability, accountability
from drivora_service.runs.candidate import CandidateSource
from drivora_service.runs.run_report import RunReport, RunSpec, RunStatus

_AT_ONCE = 100


@dataclass(frozen=True, slots=True, kw_only=True)
class Counts:
    """What happened in draws.

    Attributes:
        judged: Runs that were judged.
        at_fault: Runs in which an ego failed by its own fault.
        avoidable: Those in which a careful and competent driver would not have, or that depend on
            the ego alone.
        seconds: Wall time of a run in a worker, the mean.
    """

    judged: int = 0
    at_fault: int = 0
    avoidable: int = 0
    seconds: float = 0.0

    @property
    def interval(self) -> tuple[float, float]:
        """The exact 95 % interval of the share of avoidable failures (Clopper and Pearson)."""
        from scipy import stats

        test = stats.binomtest(self.avoidable, max(self.judged, 1))
        found = test.proportion_ci(0.95, method="exact")
        return float(found.low), float(found.high)


def count(evaluator: Evaluator, scene: Scene, draws: int, seed: int) -> Counts:
    """Draws scenarios anew, as random search does, and counts failures of the ego.

    Args:
        evaluator: Runs the candidates; it has no other user meanwhile.
        scene: The scene.
        draws: Number of draws; those that are no valid scenario, or not judged, do not count.
        seed: Seed of the draws.
    """
    search = prepare_scene(scene)
    (part,) = search.parts
    random = np.random.default_rng(seed)
    values = part.candidates.genes.sample(random, draws)
    at_fault = avoidable = judged = 0
    seconds = 0.0
    for report in run_candidates(evaluator, part, list(values)):
        if report.status is not RunStatus.FINISHED:
            continue
        found = {accountability(one) for one in violations_of(report, search.definition)}
        judged += 1
        at_fault += not found.isdisjoint(AT_FAULT)
        avoidable += Accountability.AVOIDABLE in found
        seconds += report.wall_time_s
    return Counts(
        judged=judged, at_fault=at_fault, avoidable=avoidable, seconds=seconds / max(judged, 1)
    )


def run_candidates(
    evaluator: Evaluator, part: SearchPart, values: Sequence[FloatArray]
) -> Iterator[RunReport]:
    """Runs candidates of a scene, and yields their reports as they come.

    Args:
        evaluator: Runs them; it has no other user meanwhile.
        part: What is searched in the scene.
        values: (d,) genes of each candidate.
    """
    specs = [
        RunSpec(
            run_id=f"scene-{number}",
            document="",
            candidate=CandidateSource(space=part.candidates.source, values=tuple(one.tolist())),
        )
        for number, one in enumerate(values)
    ]
    for first in range(0, len(specs), _AT_ONCE):
        evaluator.submit(list(enumerate(specs[first : first + _AT_ONCE])))
        while answers := evaluator.wait():
            yield from (answer.report for answer in answers)
