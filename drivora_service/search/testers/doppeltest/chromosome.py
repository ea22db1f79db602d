"""The chromosome of DoppelTest: egos, walkers and lights."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from drivora_service.errors import SearchError
from drivora_service.geometry.array_shapes import BoolArray, FloatArray, IntArray
from drivora_service.search.genes import Gene, GeneSpace, Part
from drivora_service.search.testers.doppeltest.sections import ActorSection

PATH = "path"
START_TIME = "start_time"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RouteConflicts:
    """Conflicts of p paths, numbered as in the egos' gene ``path``.

    Attributes:
        matrix: (p, p) symmetric; no path conflicts with itself.
    """

    matrix: BoolArray

    def between(self, path: float, others: Sequence[float]) -> bool:
        """Returns whether a path conflicts with any of ``others``."""
        return bool(self.matrix[int(path), [int(other) for other in others]].any())

    def among(self, paths: Sequence[float]) -> bool:
        """Returns whether any two of some paths conflict."""
        return any(self.matrix[int(one), int(other)] for one, other in combinations(paths, 2))

    def with_any(self, others: Sequence[float]) -> IntArray:
        """Returns the paths that conflict with any of ``others``."""
        return np.flatnonzero(self.matrix[:, [int(other) for other in others]].any(axis=1))

    def pairs(self) -> IntArray:
        """Returns the (n, 2) pairs of paths that conflict, each once."""
        return np.argwhere(np.triu(self.matrix))


class Chromosome:
    """The sections of a gene space, for the operators.

    Attributes:
        space: All genes. Genes in no section (NPC vehicles, obstacles, weather) are drawn for a
            seed and inherited by its descendants.
        egos: Section of the egos, with at least two slots.
        walkers: Section of the walkers; may have no slot.
        lights: Indices of the genes of the lights that can vary; may be empty.
        conflicts: Conflicts of the egos' paths.
    """

    def __init__(self, space: GeneSpace, conflicts: BoolArray | None) -> None:
        """Finds the sections.

        Args:
            space: All genes.
            conflicts: (p, p) which of the p paths of the egos conflict; ``None``: not known, any
                two different ones may.

        Raises:
            SearchError: Fewer than two egos vary, or no two of their paths conflict.
        """
        self.space = space
        self.egos = ActorSection(space.of(Part.EGO))
        if self.egos.most < 2:
            raise SearchError(
                f"tester 'doppeltest' needs several egos, and {self.egos.most} of the gene "
                "space's blocks are egos; set `space.egos` to 2..5"
            )
        self.walkers = ActorSection(space.of(Part.WALKER))
        self.lights: IntArray = np.array(
            [i for block in space.of(Part.LIGHTS) for i in range(block.start, block.stop)],
            dtype=np.int64,
        )
        self.lights = self.lights[space.varies[self.lights]]
        first = self.egos.blocks[0]
        self.conflicts = _conflicts(space.genes[first.index(PATH)], conflicts)

    def paths(self, values: FloatArray) -> list[float]:
        """Returns the paths of the egos."""
        egos = self.egos
        return egos.genes(values, egos.taken_slots(values), PATH)

    def draw_ego(self, random: np.random.Generator, others: list[float]) -> FloatArray:
        """Draws an ego with a path that conflicts with one of ``others``, if there is one."""
        ego = self.egos.draw(self.space, random)
        paths = self.conflicts.with_any(others)
        if len(paths):
            ego[self.egos.index(0, PATH) - self.egos.blocks[0].start] = random.choice(paths)
        return ego

    def start_early(self, values: FloatArray) -> None:
        """Shifts the start times of the egos, in place, so that the first one is 0."""
        places = [self.egos.index(slot, START_TIME) for slot in self.egos.taken_slots(values)]
        wait = min(values.item(place) - self.space.lows.item(place) for place in places)
        if wait:
            values[places] -= wait


def _conflicts(path: Gene, known: BoolArray | None) -> RouteConflicts:
    count = int(path.high) + 1
    matrix = ~np.eye(count, dtype=np.bool_) if known is None else known
    if matrix.shape != (count, count):
        raise SearchError(
            f"conflicts of {matrix.shape} paths are given, but the egos choose from {count}"
        )
    if not matrix.any():
        raise SearchError(
            f"no two of the {count} paths that the egos choose from conflict; tester 'doppeltest' "
            "needs a seed scenario at a junction, or a greater `space.reach`"
        )
    return RouteConflicts(matrix=matrix)
