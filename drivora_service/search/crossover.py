"""Crossovers: two candidates made from two others. Parents are not changed."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from drivora_service.geometry.arrays import BoolArray, FloatArray
from drivora_service.search.genes import GeneSpace

Children = tuple[FloatArray, FloatArray]
Crossover = Callable[[FloatArray, FloatArray, GeneSpace, np.random.Generator], Children]


def exchange_block(
    first: FloatArray, second: FloatArray, space: GeneSpace, random: np.random.Generator
) -> Children:
    """Exchanges one actor among those in which the parents differ."""
    differ = [b for b in space.blocks if not np.array_equal(first[b.slice], second[b.slice])]
    which = np.zeros(len(space), dtype=np.bool_)
    if differ:
        which[differ[random.integers(len(differ))].slice] = True
    return _exchange(first, second, which)


def one_point(
    first: FloatArray, second: FloatArray, space: GeneSpace, random: np.random.Generator
) -> Children:
    """Exchanges all actors from a random one on; not the first, if there are several."""
    which = np.zeros(len(space), dtype=np.bool_)
    if len(space.blocks) > 1:
        which[space.blocks[random.integers(1, len(space.blocks))].start :] = True
    return _exchange(first, second, which)


def uniform(
    first: FloatArray, second: FloatArray, space: GeneSpace, random: np.random.Generator
) -> Children:
    """Exchanges every gene with probability 1/2."""
    return _exchange(first, second, random.random(len(space)) < 0.5)


def simulated_binary(
    first: FloatArray,
    second: FloatArray,
    space: GeneSpace,
    random: np.random.Generator,
    *,
    eta: float = 15.0,
    rate: float = 0.5,
) -> Children:
    """Spreads magnitudes around both parents (SBX); categories are exchanged.

    Source: Deb and Agrawal, "Simulated binary crossover for continuous search space" (1995), in
    the bounded form of pymoo. Whole numbers are rounded.

    Args:
        first: (d,) genes of one parent.
        second: (d,) genes of the other.
        space: Their bounds.
        random: Generator for every draw.
        eta: Distribution index; the greater, the nearer children are to their parents.
        rate: Probability with which a gene takes part.
    """
    # Imported here: pymoo takes half a second, which code that only reads campaigns must not wait.
    from pymoo.operators.crossover.sbx import cross_sbx

    spread = cross_sbx(
        np.stack((first, second))[:, None, :],
        space.lows,
        space.highs,
        np.array([[eta]]),
        np.array([[rate]]),
        np.array([[0.5]]),
        random_state=random,
    )
    exchanged = _exchange(first, second, random.random(len(space)) < rate)
    one, other = (
        np.where(space.is_category, swapped, space.clip(np.asarray(child, dtype=np.float64)))
        for swapped, child in zip(exchanged, spread[:, 0], strict=True)
    )
    return one, other


def _exchange(first: FloatArray, second: FloatArray, which: BoolArray) -> Children:
    return np.where(which, second, first), np.where(which, first, second)
