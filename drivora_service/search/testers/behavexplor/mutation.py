"""BehAVExplor's mutation of seeds with high energy: Gaussian noise on waypoints."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from drivora_service.geometry.array_shapes import BoolArray, FloatArray, IntArray
from drivora_service.search.genes import GeneKind, GeneSpace, Part
from drivora_service.search.mutation import effective_genes, shift_genes

_ALONG, _SPEED = "along_", "speed_"


@dataclass(frozen=True, slots=True, kw_only=True)
class WaypointNoise:
    """Moves waypoints of vehicles, in place and speed together, by normal draws.

    The types, paths and lanes of vehicles are kept. Magnitudes that are no waypoints (starts,
    walkers, weather ...) move independently. At least one gene moves: repeating a candidate in a
    deterministic simulator would give no new information.

    Attributes:
        probability: Probability with which a waypoint, or another magnitude, moves.
        along_sigma: Standard deviation of a waypoint's place along the path at strength 1, metres.
        speed_sigma: Standard deviation of its speed, m/s.
        spread: Standard deviation of all other magnitudes, as a share of their range; 0: none.
    """

    probability: float = 0.5
    along_sigma: float = 12.0
    speed_sigma: float = 6.0
    spread: float = 1.0 / 3.0

    def mutate(
        self,
        values: FloatArray,
        space: GeneSpace,
        random: np.random.Generator,
        *,
        strength: float = 1.0,
    ) -> FloatArray:
        """Returns a changed copy."""
        sigma, unit = self.plan(space)
        movable = (sigma > 0.0) & effective_genes(values, space)
        moves: BoolArray = (random.random(len(space)) < self.probability)[unit]
        if movable.any() and not (moves & movable).any():
            moves = unit == unit[random.choice(np.flatnonzero(movable))]
        return shift_genes(values, space, random, moves & movable, sigma * strength)

    @lru_cache(maxsize=4)  # noqa: B019 # of a frozen value, and for as many spaces only
    def plan(self, space: GeneSpace) -> tuple[FloatArray, IntArray]:
        """Returns how far each gene moves, and with which others.

        Returns:
            (d,) standard deviations in the genes' units, 0 for fixed genes; and (d,) for each gene
            the index of the gene with which it moves, its own or that of its waypoint.
        """
        sigma = np.zeros(len(space))
        unit = np.arange(len(space))
        for block in space.blocks:
            heads: dict[str, int] = {}
            for index, gene in enumerate(block.genes, start=block.start):
                if gene.kind is not GeneKind.CONTINUOUS:
                    continue
                is_waypoint = block.part is Part.VEHICLE
                if is_waypoint and gene.name.startswith(_ALONG):
                    sigma[index] = self.along_sigma
                elif is_waypoint and gene.name.startswith(_SPEED):
                    sigma[index] = self.speed_sigma
                else:
                    sigma[index] = self.spread * (gene.high - gene.low)
                    continue
                unit[index] = heads.setdefault(gene.name.rpartition("_")[2], index)
        return np.where(space.varies, sigma, 0.0), unit
