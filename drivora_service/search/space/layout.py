"""Making genes, and arranging them in blocks."""

from __future__ import annotations

from collections.abc import Sequence

from drivora_service.search.genes import Block, Gene, GeneKind, Part


class Layout:
    """Arranges blocks one after another."""

    def __init__(self) -> None:
        self._blocks: list[Block] = []

    def add(self, name: str, part: Part, genes: Sequence[Gene], actor: str = "") -> Block:
        """Adds and returns the next block; see :class:`Block`."""
        start = self._blocks[-1].stop if self._blocks else 0
        block = Block(name=name, part=part, start=start, genes=tuple(genes), actor=actor)
        self._blocks.append(block)
        return block

    @property
    def blocks(self) -> tuple[Block, ...]:
        """All blocks, in order."""
        return tuple(self._blocks)


def number(name: str, low: float, high: float, unit: str = "") -> Gene:
    """Returns a gene that is a magnitude."""
    return Gene(name=name, kind=GeneKind.CONTINUOUS, low=low, high=high, unit=unit)


def whole(name: str, low: int, high: int) -> Gene:
    """Returns a gene that is a whole number in an order."""
    return Gene(name=name, kind=GeneKind.INTEGER, low=float(low), high=float(high))


def choice(name: str, count: int) -> Gene:
    """Returns a gene that chooses one of ``count``."""
    return Gene(name=name, kind=GeneKind.CATEGORY, low=0.0, high=count - 1.0)


def presence(*, optional: bool) -> Gene:
    """Returns the gene of an actor's presence."""
    return whole("present", 0 if optional else 1, 1)
