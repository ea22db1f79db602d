"""Preparing a candidate in the worker process: repair, decode, check."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from drivora_service.runs.candidate import Candidate, CandidateSource, SpaceSource
from drivora_service.search.candidate_space import CandidateSpace
from drivora_service.search.space.source import space_of
from drivora_service.search.space.space_candidates import ScenarioCandidates
from drivora_service.simulation.followers.free_motion import plan_motions
from drivora_service.worker.setup import WorkerSetup
from drivora_service.worker.worker_catalogues import agents_of, networks_of


def prepare(source: CandidateSource, setup: WorkerSetup) -> Candidate:
    """Decodes genes and checks their scenario.

    Args:
        source: The genes and their space.
        setup: Set-up of the worker.

    Raises:
        DrivoraError: The space cannot be built here.
    """
    candidates = _candidates(source.space, setup)
    return candidates.prepare(np.array(source.values), source.reference)


def space_of_candidates(source: SpaceSource, setup: WorkerSetup) -> CandidateSpace:
    """Returns the space in which a worker decodes genes."""
    return _candidates(source, setup).space


@lru_cache(maxsize=64)
def _candidates(space: SpaceSource, setup: WorkerSetup) -> ScenarioCandidates:
    """Returns the candidates of a space, which takes as long to build as a part of a run.

    The campaigns of a study take turns on a worker, each with spaces of its own.
    """
    networks = networks_of(setup)
    return ScenarioCandidates(
        space=space_of(space, networks),
        networks=networks,
        agents=frozenset(agents_of(setup).names()),
        motions=plan_motions,
    )
