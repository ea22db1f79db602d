"""Readable numbers: the values of a document with fewer decimals."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from drivora_service.scenario.documents import ScenarioDocument
from drivora_service.suites.minimization.edits import Edit, Place, content_of

DECIMALS = (0, 1, 2, 3)
"""Numbers of decimals that are tried, the most readable one first."""

_KEPT = frozenset({"agent", "extensions", "reference_path", "step_length"})
"""Keys below which values are not of the scenario, or are how it is simulated or judged."""


def make_roundings(document: ScenarioDocument, decimals: int) -> list[Edit]:
    """Returns the rounding of each number that has more decimals."""
    return [
        Edit(
            changes=((place, _round(value, decimals)),),
            label=f"{'/'.join(map(str, place))} with {decimals} decimals",
        )
        for place, value in numbers(content_of(document))
        if _round(value, decimals) != value
    ]


def numbers(part: Any, place: Place = ()) -> Iterator[tuple[Place, float]]:
    """Yields the numbers of a document's content that are rounded, with their places."""
    if isinstance(part, float):
        yield place, part
    elif isinstance(part, dict):
        for key, value in part.items():
            if key not in _KEPT:
                yield from numbers(value, (*place, key))
    elif isinstance(part, list | tuple):
        for index, item in enumerate(part):
            yield from numbers(item, (*place, index))


def _round(value: float, decimals: int) -> float:
    # Not -0.0, which reads as if it were something.
    return round(value, decimals) + 0.0
