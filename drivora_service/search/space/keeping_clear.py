"""Redrawing actors that would enter the area that an ego could use on its reference path."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.runs.candidate import Reference
from drivora_service.scenario.model import ReferencePose, Scenario
from drivora_service.search.candidate_space import CandidateSpace
from drivora_service.search.genes import Part
from drivora_service.search.space.usable_area import PlannedMotions, intruders

MAX_TRIES = 20
"""Times that an actor is redrawn before it becomes absent (as in the public code of Decictor)."""

_ACTORS = (Part.VEHICLE, Part.WALKER, Part.OBSTACLE)


def with_reference(scenario: Scenario, reference: Reference) -> Scenario:
    """Returns a scenario whose egos have the paths of a reference, if it has any."""
    if not reference.paths:
        return scenario
    egos = tuple(
        replace(ego, reference_path=_poses(path))
        for ego, path in zip(scenario.ego_vehicles, reference.paths, strict=True)
    )
    return replace(scenario, ego_vehicles=egos)


def keep_clear(
    space: CandidateSpace,
    values: FloatArray,
    complete: Callable[[Scenario], Scenario],
    motions: PlannedMotions,
) -> tuple[FloatArray, Scenario]:
    """Redraws actors that may be absent until none is planned to enter the area of an ego.

    What is drawn depends on the values alone. An actor for which no place is found becomes absent.

    Args:
        space: The gene space.
        values: (d,) repaired genes; not changed.
        complete: Adds the reference paths to a scenario.
        motions: Plans the motions of actors.

    Returns:
        The genes, repaired, and their scenario.
    """
    blocks = {block.actor: block for block in space.genes.optional_blocks if block.part in _ACTORS}
    names = frozenset(blocks)
    seed = hashlib.sha256(values.tobytes()).digest()
    random = np.random.default_rng(np.frombuffer(seed, dtype=np.uint32))
    found = values.copy()
    attempt = -1
    while True:
        attempt += 1
        scenario = complete(space.scenario(found))
        inside = intruders(scenario, space.network, names, motions)
        if not inside:
            return found, scenario
        fresh = space.genes.sample(random)
        for block in (blocks[name] for name in sorted(inside)):
            if attempt < MAX_TRIES:
                found[block.start + 1 : block.stop] = fresh[block.start + 1 : block.stop]
            else:
                found[block.start] = 0.0
        # Repairing may move others: they are checked again.
        found = space.repair(found)


@lru_cache(maxsize=16)
def _poses(path: tuple[tuple[float, ...], ...]) -> tuple[ReferencePose, ...]:
    """Returns the poses of a path; cached, as the candidates of a campaign share theirs."""
    return tuple(
        ReferencePose(time=time, x=x, y=y, yaw=yaw, speed=speed, z=z or None)
        for time, x, y, yaw, speed, z in path
    )
