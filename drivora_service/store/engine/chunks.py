"""Cutting long lists of parameters, whose number databases limit."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TypeVar

Item = TypeVar("Item")


def batched(items: Sequence[Item], size: int = 500) -> Iterator[Sequence[Item]]:
    """Cuts ``items`` into pieces of at most ``size``."""
    for start in range(0, len(items), size):
        yield items[start : start + size]
