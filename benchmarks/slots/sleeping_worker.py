"""A worker that only waits as long as a run takes, and answers with a real report.

With it, real slots, keepers and channels can be measured with more workers than there are cores.
"""

from __future__ import annotations

import random
import time
from dataclasses import dataclass, replace

from drivora_service.runs.candidate import Candidate, CandidateSource
from drivora_service.runs.run_report import RunReport, RunSpec
from drivora_service.worker.progress_board import ProgressBoard


@dataclass(frozen=True, slots=True, kw_only=True)
class Sleep:
    """The set-up of a worker that waits.

    Attributes:
        run_s: Mean seconds of a run; a run differs from it by at most a fifth.
        report: Answer, apart from the run's id and its duration.
    """

    run_s: float
    report: RunReport


def warm_up(_setup: Sleep) -> None:
    """Does nothing; a worker with a warm-up is forked with its imports made."""


def perform(spec: RunSpec, setup: Sleep, _board: ProgressBoard) -> RunReport:
    """Waits, and returns the report of the set-up."""
    seconds = setup.run_s * random.Random(spec.run_id).uniform(0.8, 1.2)
    begun = time.perf_counter()
    time.sleep(seconds)
    return replace(setup.report, run_id=spec.run_id, wall_time_s=time.perf_counter() - begun)


def prepare(source: CandidateSource, _setup: Sleep) -> Candidate:
    """Returns the seed scenario: workers that wait leave the cores to what is measured."""
    return make_seed_candidate(source)


def make_seed_candidate(source: CandidateSource) -> Candidate:
    """Returns the seed scenario as the candidate of any genes."""
    return Candidate(values=source.values, document=source.space.seed)
