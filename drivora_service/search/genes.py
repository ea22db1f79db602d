"""Genes: a scenario's variation as one vector of fixed length.

Every gene has a native value in SI units, float64 also for counts and choices. Genes of one actor
(or of the weather, or of the lights) form a block, so that operators can exchange or redraw an
actor as a whole.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property

import numpy as np

from drivora_service.errors import SearchError
from drivora_service.geometry.arrays import BoolArray, FloatArray


class GeneKind(StrEnum):
    """The meaning of a gene's values."""

    CONTINUOUS = "continuous"
    """A magnitude: neighbours are alike."""
    INTEGER = "integer"
    """A whole number in an order."""
    CATEGORY = "category"
    """One of several without an order: 0, 1, 2 and so on."""


class Part(StrEnum):
    """The part of a scenario that a block of genes varies."""

    EGO = "ego"
    VEHICLE = "vehicle"
    WALKER = "walker"
    OBSTACLE = "obstacle"
    WEATHER = "weather"
    LIGHTS = "lights"


@dataclass(frozen=True, slots=True, kw_only=True)
class Gene:
    """One entry of the vector.

    Attributes:
        name: Name within its block, such as ``speed_2``.
        kind: Meaning of its values.
        low: Least value allowed.
        high: Greatest value allowed, inclusive; equal to ``low`` if it does not vary.
        unit: SI unit, or "".
    """

    name: str
    kind: GeneKind
    low: float
    high: float
    unit: str = ""

    def __post_init__(self) -> None:
        if not (np.isfinite(self.low) and np.isfinite(self.high) and self.low <= self.high):
            raise SearchError(
                f"gene {self.name!r} has the bounds {self.low} and {self.high}; both must be "
                "finite and in order"
            )


@dataclass(frozen=True, slots=True, kw_only=True)
class Block:
    """The genes of one actor, of the weather or of the lights.

    Attributes:
        name: Name, such as ``vehicle_0``.
        start: Index of the first of its genes in the vector.
        genes: Its genes, in order. An actor that may be absent has ``present`` (0 or 1) first.
        actor: Id of the actor in scenarios, which differs from the name if the seed scenario has an
            ego of its own for it, or another actor of that name; "" for weather and lights.
    """

    name: str
    part: Part
    start: int
    genes: tuple[Gene, ...]
    actor: str = ""

    @property
    def stop(self) -> int:
        """Index after its last gene."""
        return self.start + len(self.genes)

    @property
    def slice(self) -> slice:
        """Its place in the vector."""
        return slice(self.start, self.stop)

    @property
    def is_optional(self) -> bool:
        """Whether its actor may be absent."""
        first = self.genes[0]
        return first.name == "present" and first.low < first.high

    def index(self, gene: str) -> int:
        """Returns the index in the vector of one of its genes.

        Raises:
            SearchError: The block has no such gene.
        """
        for offset, known in enumerate(self.genes):
            if known.name == gene:
                return self.start + offset
        names = ", ".join(known.name for known in self.genes)
        raise SearchError(f"block {self.name!r} has no gene {gene!r}; it has {names}")

    def indices(self, prefix: str) -> tuple[int, ...]:
        """Returns the indices of its genes ``prefix_0``, ``prefix_1`` and so on, in order."""
        return tuple(
            self.start + offset
            for offset, gene in enumerate(self.genes)
            if gene.name.rpartition("_")[0] == prefix
        )


class GeneSpace:
    """All genes of a campaign, with their bounds.

    Attributes:
        blocks: In the order of the vector.
        genes: All genes, in the order of the vector.
    """

    def __init__(self, blocks: tuple[Block, ...]) -> None:
        """Takes contiguous blocks.

        Raises:
            SearchError: The blocks are not contiguous, or there is no gene.
        """
        expected = 0
        for block in blocks:
            if block.start != expected:
                raise SearchError(f"block {block.name!r} begins at {block.start}, not {expected}")
            expected = block.stop
        if not expected:
            raise SearchError("the gene space is empty: vary at least one part of the scenario")
        self.blocks = blocks
        self.genes = tuple(gene for block in blocks for gene in block.genes)

    def __len__(self) -> int:
        """Returns the number of genes."""
        return len(self.genes)

    @cached_property
    def lows(self) -> FloatArray:
        """(d,) least values."""
        return np.array([gene.low for gene in self.genes])

    @cached_property
    def highs(self) -> FloatArray:
        """(d,) greatest values."""
        return np.array([gene.high for gene in self.genes])

    @cached_property
    def is_whole(self) -> BoolArray:
        """(d,) genes whose values are whole numbers."""
        return np.array([gene.kind is not GeneKind.CONTINUOUS for gene in self.genes])

    @cached_property
    def is_category(self) -> BoolArray:
        """(d,) genes whose values have no order."""
        return np.array([gene.kind is GeneKind.CATEGORY for gene in self.genes])

    @cached_property
    def varies(self) -> BoolArray:
        """(d,) genes that can have more than one value."""
        varies: BoolArray = self.lows < self.highs
        return varies

    def of(self, part: Part) -> tuple[Block, ...]:
        """Returns the blocks of one part."""
        return tuple(block for block in self.blocks if block.part is part)

    def sample(self, random: np.random.Generator, count: int | None = None) -> FloatArray:
        """Draws uniformly: (d,), or (count, d). Whole genes are drawn with both bounds included."""
        shape = (len(self),) if count is None else (count, len(self))
        return self.from_unit(random.random(shape))

    def clip(self, values: FloatArray) -> FloatArray:
        """Rounds whole genes and clips every value to its bounds; (..., d)."""
        rounded = np.where(self.is_whole, np.round(values), values)
        clipped: FloatArray = np.clip(rounded, self.lows, self.highs)
        return clipped

    def to_unit(self, values: FloatArray) -> FloatArray:
        """Maps values (..., d) to 0..1; genes that do not vary to 0. Whole genes get cell centres.

        ``from_unit`` is the inverse.
        """
        cells = np.where(self.is_whole, self.highs - self.lows + 1.0, self.highs - self.lows)
        shift = np.where(self.is_whole, 0.5, 0.0)
        width = np.where(self.varies, cells, 1.0)
        unit: FloatArray = np.where(self.varies, (values - self.lows + shift) / width, 0.0)
        return unit

    def from_unit(self, unit: FloatArray) -> FloatArray:
        """Maps 0..1 (..., d) to values; whole genes have cells of equal width."""
        unit = np.clip(unit, 0.0, 1.0)
        cells = self.highs - self.lows + 1.0
        whole = np.minimum(np.floor(self.lows + unit * cells), self.highs)
        spread = self.lows + unit * (self.highs - self.lows)
        values: FloatArray = np.where(self.is_whole, whole, np.minimum(spread, self.highs))
        return values

    def within(self, values: FloatArray) -> bool:
        """Returns whether values (d,) are finite, within the bounds, and whole for whole genes."""
        if values.shape != (len(self),) or not np.isfinite(values).all():
            return False
        return bool(np.array_equal(self.clip(values), values))
