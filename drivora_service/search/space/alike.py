"""Whether two candidates decode to scenarios that cannot be told apart by their runs.

Many genes are without an effect at some values: a lane to the side that the road does not have
there, a speed above the limit, clouds at noon.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.scenario.model import Weather
from drivora_service.scenario.weather import weather_effects
from drivora_service.search.genes import Block
from drivora_service.search.space.actor_starts import Start

Decoded: TypeAlias = tuple[object, Start | None]
"""A part of a scenario, and where it starts if it is an actor."""

ABSENT: Decoded = (None, None)

Decode: TypeAlias = Callable[[FloatArray], Decoded]


def decode_alike(
    parts: tuple[tuple[Block, Decode], ...], one: FloatArray, other: FloatArray
) -> bool:
    """Returns whether every part of two candidates (d,) is the same.

    Starts are compared to the last digit, which documents round off: then repairing, which moves
    starts, does the same with both.

    Args:
        parts: All blocks of genes with what decodes them.
        one: Repaired genes.
        other: Genes within the bounds.
    """
    changed = one != other
    return all(
        _same(decode(one), decode(other)) for block, decode in parts if changed[block.slice].any()
    )


def _same(one: Decoded, other: Decoded) -> bool:
    first, second = one[0], other[0]
    if isinstance(first, Weather) and isinstance(second, Weather):
        # Runs know nothing else of the weather.
        return weather_effects(first) == weather_effects(second)
    return first == second and _same_start(one[1], other[1])


def _same_start(one: Start | None, other: Start | None) -> bool:
    if one is None or other is None:
        return one is other
    facts = [(a.pose, a.speed, a.appears, a.until, a.length, a.width) for a in (one, other)]
    return facts[0] == facts[1]
