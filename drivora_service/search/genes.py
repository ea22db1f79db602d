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
from drivora_service.geometry.array_shapes import BoolArray, FloatArray, IntArray


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
    PATCH = "patch"
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
        actor: Id of the actor or patch in scenarios, which differs from the name if the seed
            scenario has an ego of its own for it, or another actor of that name; "" for weather
            and lights.
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


Slices = tuple[tuple[int, ...], ...]
"""Indices of genes, one group a time slice."""


def slices_of(block: Block, which: BoolArray) -> Slices:
    """Groups the indices of a block's genes by time slice.

    Args:
        block: An actor.
        which: (d,) genes that count.

    Returns:
        Indices in the vector; first those without a slice, then slice by slice. No group is empty.
    """
    groups: dict[int, list[int]] = {}
    for index, gene in enumerate(block.genes, start=block.start):
        if which[index]:
            number = gene.name.rpartition("_")[2]
            groups.setdefault(int(number) if number.isdecimal() else -1, []).append(index)
    return tuple(tuple(groups[number]) for number in sorted(groups))


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
    def names(self) -> tuple[str, ...]:
        """The names of all genes with those of their blocks, such as ``vehicle_0.speed_2``."""
        return tuple(f"{block.name}.{gene.name}" for block in self.blocks for gene in block.genes)

    @cached_property
    def units(self) -> tuple[str, ...]:
        """The SI unit of each gene, "" without one."""
        return tuple(gene.unit for gene in self.genes)

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

    @cached_property
    def ranges(self) -> FloatArray:
        """(d,) greatest minus least values."""
        ranges: FloatArray = self.highs - self.lows
        return ranges

    @cached_property
    def cells(self) -> FloatArray:
        """(d,) numbers of values of the genes that are whole."""
        cells: FloatArray = self.ranges + 1.0
        return cells

    @cached_property
    def starts(self) -> IntArray:
        """Indices of the first gene of each block."""
        return np.array([block.start for block in self.blocks])

    @cached_property
    def optional_blocks(self) -> tuple[Block, ...]:
        """The blocks of actors that may be absent."""
        return tuple(block for block in self.blocks if block.is_optional)

    @cached_property
    def varying_blocks(self) -> tuple[Block, ...]:
        """The blocks with a gene that can vary."""
        return tuple(block for block in self.blocks if self.varies[block.slice].any())

    @cached_property
    def varying_slices(self) -> tuple[tuple[Block, Slices], ...]:
        """The blocks with a gene that can vary, and their genes that can, by time slice."""
        return tuple((block, slices_of(block, self.varies)) for block in self.varying_blocks)

    @cached_property
    def at_least_one(self) -> FloatArray:
        """(d,) ranges, or 1 if they are less."""
        return np.maximum(self.ranges, 1.0)

    @cached_property
    def both_ways(self) -> FloatArray:
        """(d,) twice the ranges, and 2 for genes that do not vary."""
        both_ways: FloatArray = 2.0 * np.where(self.varies, self.ranges, 1.0)
        return both_ways

    @cached_property
    def _widths(self) -> FloatArray:
        """(d,) lengths to which 0..1 is scaled."""
        return np.where(self.is_whole, self.cells, self.ranges)

    def of(self, part: Part) -> tuple[Block, ...]:
        """Returns the blocks of one part."""
        return tuple(block for block in self.blocks if block.part is part)

    def sample(self, random: np.random.Generator, count: int | None = None) -> FloatArray:
        """Draws uniformly: (d,), or (count, d). Whole genes are drawn with both bounds included."""
        shape = (len(self),) if count is None else (count, len(self))
        return self.scale_in_place(random.random(shape))

    def clip(self, values: FloatArray) -> FloatArray:
        """Rounds whole genes and clips every value to its bounds; (..., d)."""
        clipped: FloatArray = np.array(values, dtype=np.float64)
        np.rint(clipped, out=clipped, where=self.is_whole)
        return clipped.clip(self.lows, self.highs, out=clipped)

    def to_unit(self, values: FloatArray) -> FloatArray:
        """Maps values (..., d) to 0..1; genes that do not vary to 0. Whole genes get cell centres.

        ``from_unit`` is the inverse.
        """
        shift = np.where(self.is_whole, 0.5, 0.0)
        width = np.where(self.varies, self._widths, 1.0)
        unit: FloatArray = np.where(self.varies, (values - self.lows + shift) / width, 0.0)
        return unit

    def from_unit(self, unit: FloatArray) -> FloatArray:
        """Maps 0..1 (..., d) to values; whole genes have cells of equal width."""
        return self.scale_in_place(np.clip(unit, 0.0, 1.0))

    def scale_in_place(self, unit: FloatArray) -> FloatArray:
        """Maps 0..1 (..., d), which it overwrites, to values: ``from_unit`` without a check."""
        unit *= self._widths
        unit += self.lows
        np.floor(unit, out=unit, where=self.is_whole)
        return np.minimum(unit, self.highs, out=unit)

    def within(self, values: FloatArray) -> bool:
        """Returns whether values (d,) are finite, within the bounds, and whole for whole genes."""
        if values.shape != (len(self),) or not np.isfinite(values).all():
            return False
        return bool(np.array_equal(self.clip(values), values))
