"""How BehAVExplor changes a parent that is worth staying near: Gaussian noise on waypoints."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drivora_service.geometry.arrays import BoolArray, FloatArray, IntArray
from drivora_service.search.genes import GeneKind, GeneSpace, Part
from drivora_service.search.mutation import effective_genes, shifted

_ALONG, _SPEED = "along_", "speed_"


@dataclass(frozen=True, slots=True, kw_only=True)
class WaypointNoise:
    """Moves waypoints of vehicles, in place and speed together, by normal draws.

    The types, paths and lanes of vehicles stay. Magnitudes that are no waypoints (starts, walkers,
    weather ...) move each for itself. At least one thing moves: the same candidate again would tell
    nothing new of a simulator that repeats itself.

    Attributes:
        probability: With which a waypoint, or another magnitude, moves.
        along_sigma: Standard deviation of a waypoint's place along the path at strength 1, metres.
        speed_sigma: Of its speed, m/s.
        spread: Of all other magnitudes, as a share of their range; 0 leaves them alone.
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
        return shifted(values, space, random, moves & movable, sigma * strength)

    def plan(self, space: GeneSpace) -> tuple[FloatArray, IntArray]:
        """Tells how the genes move.

        Returns:
            (d,) standard deviations in the genes' units, 0 for those that stay; and (d,) for each
            gene the index of the gene with which it moves, its own or that of its waypoint.
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
