"""DriveFuzz's mutation in a gene space: something is added to a scenario.

To add an actor or a patch is to switch the block of an absent one on and to draw its genes; if all
of its kind are present, one of them is drawn anew.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.search.genes import Block, GeneSpace, Part

ADDED = (Part.VEHICLE, Part.WALKER, Part.OBSTACLE, Part.PATCH)
"""Parts of which something can be added."""
_SUN = "sun_altitude_angle"
_PRESENT = "present"

Distance = Callable[[Block, FloatArray], float | None]


class Navigation(StrEnum):
    """How a new actor moves (DriveFuzz's navigation types)."""

    LINEAR = "linear"
    """On its way at one speed."""
    AUTOPILOT = "autopilot"
    """With speeds and lanes of its own at each place."""
    IMMOBILE = "immobile"
    """It stands, as an obstacle; as slow as can be where the space has no obstacles."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Addition:
    """A mutant: its genes (d,), and the part that was added or changed."""

    values: FloatArray
    part: Part


class Adding:
    """Adds actors, patches and weather to scenarios."""

    def __init__(
        self,
        space: GeneSpace,
        random: np.random.Generator,
        *,
        distance: Distance | None,
        reach: tuple[float, float],
        chances: tuple[float, float],
        tries: int,
    ) -> None:
        """Creates the mutation.

        Args:
            space: The genes.
            random: Generator for every draw.
            distance: Returns from a block and genes the metres from an ego at which it appears.
            reach: Least and greatest metres at which an actor appears.
            chances: Probabilities of a patch and of another weather.
            tries: Draws of an actor until it is in reach.
        """
        self._space, self._random = space, random
        self._distance, self._reach, self._tries = distance, reach, tries
        self._blocks = {
            part: tuple(block for block in space.of(part) if block.is_optional) for part in ADDED
        }
        self._weather = tuple(
            block for block in space.of(Part.WEATHER) if space.varies[block.slice].any()
        )
        self._targets, self._shares = self._choices(*chances)

    def _choices(self, patch: float, weather: float) -> tuple[tuple[Part, ...], FloatArray]:
        """Returns what can be added, and how often; what the space has not leaves its share."""
        wanted = {
            Part.PATCH: patch if self._blocks[Part.PATCH] else 0.0,
            Part.WEATHER: weather if self._weather else 0.0,
        }
        actors = any(self._blocks[part] for part in (Part.VEHICLE, Part.WALKER, Part.OBSTACLE))
        wanted[Part.VEHICLE] = max(1.0 - patch - weather, 0.0) if actors else 0.0
        shares = np.array([*wanted.values()])
        total = float(shares.sum())
        return tuple(wanted), shares / total if total > 0.0 else shares

    @property
    def is_possible(self) -> bool:
        """Whether there is an actor or a patch that may be absent."""
        return any(self._blocks.values())

    def blank(self) -> FloatArray:
        """Returns a new seed (d,): nothing is added yet, and the weather is calm and clear.

        Everything else (egos that vary, lights, actors that are always there) is drawn.
        """
        space = self._space
        values = space.sample(self._random)
        for blocks in self._blocks.values():
            for block in blocks:
                values[block.start] = 0.0
        for block in self._weather:
            values[block.slice] = space.lows[block.slice]
            for index, gene in enumerate(block.genes, start=block.start):
                if gene.name == _SUN:
                    values[index] = gene.high
        return values

    def add(self, parent: FloatArray) -> Addition:
        """Returns a mutant of a parent (d,)."""
        drawn = self._random.random()
        target = self._targets[int(np.searchsorted(np.cumsum(self._shares), drawn, side="right"))]
        values = parent.copy()
        if target is Part.WEATHER:
            fresh = self._space.sample(self._random)
            for block in self._weather:
                values[block.slice] = fresh[block.slice]
            return Addition(values=values, part=Part.WEATHER)
        if target is Part.PATCH:
            block = self._choose_block(self._blocks[Part.PATCH], values)
            self._draw(block, values, None)
            return Addition(values=values, part=Part.PATCH)
        part, navigation = self._actor()
        block = self._choose_block(self._blocks[part], values)
        self._place(block, values, navigation)
        return Addition(values=values, part=part)

    def _actor(self) -> tuple[Part, Navigation]:
        """Draws the kind of a new actor and its navigation."""
        kinds = [part for part in (Part.VEHICLE, Part.WALKER) if self._blocks[part]]
        standing = self._blocks[Part.OBSTACLE]
        navigation = list(Navigation)[self._random.integers(len(Navigation))]
        if standing and (navigation is Navigation.IMMOBILE or not kinds):
            return Part.OBSTACLE, Navigation.IMMOBILE
        return kinds[self._random.integers(len(kinds))], navigation

    def _choose_block(self, blocks: Sequence[Block], values: FloatArray) -> Block:
        """Draws one of the absent blocks; of all, if none is absent."""
        absent = [block for block in blocks if values[block.start] == 0.0]
        among = absent or list(blocks)
        return among[self._random.integers(len(among))]

    def _place(self, block: Block, values: FloatArray, navigation: Navigation) -> None:
        """Draws an actor until it appears in reach of an ego; else the one that comes nearest."""
        best, least = values.copy(), math.inf
        for _ in range(self._tries if self._distance is not None else 1):
            self._draw(block, values, navigation)
            away = self._beyond(block, values)
            if away < least:
                best, least = values.copy(), away
            if away == 0.0:
                break
        values[:] = best

    def _beyond(self, block: Block, values: FloatArray) -> float:
        """Returns the metres by which an actor appears out of reach, 0 within it."""
        distance = None if self._distance is None else self._distance(block, values)
        if distance is None:
            return 0.0
        nearest, farthest = self._reach
        return max(nearest - distance, distance - farthest, 0.0)

    def _draw(self, block: Block, values: FloatArray, navigation: Navigation | None) -> None:
        """Draws the genes of a block in place, and switches it on."""
        fresh = self._space.sample(self._random)
        speed = float(self._random.random())
        values[block.slice] = fresh[block.slice]
        for index, gene in enumerate(block.genes, start=block.start):
            kind = gene.name.partition("_")[0]
            if gene.name == _PRESENT:
                values[index] = gene.high
            elif navigation in (Navigation.LINEAR, Navigation.IMMOBILE):
                if kind == "speed":
                    share = speed if navigation is Navigation.LINEAR else 0.0
                    values[index] = gene.low + share * (gene.high - gene.low)
                elif kind in ("lane", "along", "angle"):
                    # Straight on: the middle of these genes.
                    values[index] = min(max(0.0, gene.low), gene.high)
