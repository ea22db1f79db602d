"""Where the NPC vehicles of a candidate drive, and from where on each of their genes has an effect.

A vehicle keeps to its path, whatever its genes are, but for the one that chooses the path. The
desired speed of a waypoint counts on the way to it, and before that as far as the vehicle brakes
for it.
"""

from __future__ import annotations

from dataclasses import dataclass

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.search.genes import Block

BESIDE = 8.0
"""Metres from its path within which a vehicle is on any of the lanes that its genes choose from."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SpeedGene:
    """A gene of a desired speed that moves no start.

    Attributes:
        index: Index in the vector.
        after: Arc length on the path from which on the speed is planned for, metres.
        before: The greatest speed that is planned up to there, m/s.
    """

    index: int
    after: float
    before: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class VehicleWay:
    """The way of one NPC vehicle that is present.

    Attributes:
        block: Its genes.
        line: (n, 2) its path, metres, points at most 1 m apart; it drives within ``BESIDE`` of it.
        arc: (n,) arc length of each point, metres.
        speeds: Genes of its speeds, without the first, which also decides on starts.
        places: Indices of the genes of the places and lanes of its waypoints: they change the line
            that it drives, near its path, as a whole.
    """

    block: Block
    line: FloatArray
    arc: FloatArray
    speeds: tuple[SpeedGene, ...]
    places: tuple[int, ...]
