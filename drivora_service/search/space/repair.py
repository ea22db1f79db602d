"""Moving actors that would appear too near to one another, by changing their genes."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from drivora_service.geometry.arrays import FloatArray
from drivora_service.search.space.starts import Start, too_near

STEP = 2.0
"""Metres by which an actor is moved at a time."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Mover:
    """An actor whose start the genes decide.

    Attributes:
        start: Returns where it appears, from the values of all genes.
        room: Returns the metres that the shift gene moves it by from 0 to 1.
        shift_gene: Index of the gene that moves it.
        alternatives: Indices and values of genes to be tried one by one, in order, where it has no
            free place as it is.
        is_refused: Tells whether a start is bad for another reason than those who are near it.
    """

    start: Callable[[FloatArray], Start]
    room: Callable[[FloatArray], float]
    shift_gene: int
    alternatives: tuple[tuple[int, float], ...] = ()
    is_refused: Callable[[Start], bool] | None = None


def settle(values: FloatArray, mover: Mover, taken: list[Start]) -> None:
    """Moves an actor to the nearest free place, and notes in ``taken`` where it is then.

    It is moved along its path, forwards and backwards in growing steps; where all of it is taken,
    so it is done with each of its alternatives. Where nothing is free it stays as it was.

    Args:
        values: (d,) genes; those of the actor are changed.
        mover: The actor.
        taken: Where others appear.
    """
    before = values.copy()
    for start in _tries(values, mover):
        if mover.is_refused is not None and mover.is_refused(start):
            continue
        if not any(too_near(start, other) for other in taken):
            taken.append(start)
            return
    values[:] = before
    taken.append(mover.start(values))


def _tries(values: FloatArray, mover: Mover) -> Iterator[Start]:
    """Changes the values from one place to the next, and gives each place."""
    wanted = float(values[mover.shift_gene])
    unchanged = (mover.shift_gene, wanted)
    for gene, value in (unchanged, *mover.alternatives):
        before = values[gene]
        values[gene] = value
        for share in _shares(wanted, mover.room(values)):
            values[mover.shift_gene] = share
            yield mover.start(values)
        values[mover.shift_gene] = wanted
        values[gene] = before


def other_choices(gene: int, values: FloatArray, count: int) -> tuple[tuple[int, float], ...]:
    """Returns the other values of a gene that chooses one of ``count``, the next ones first."""
    own = int(values[gene])
    return tuple((gene, float((own + onward) % count)) for onward in range(1, count))


def _shares(wanted: float, room: float) -> Iterator[float]:
    """Returns shares of a room in metres, first the wanted, then ever further away from it."""
    yield wanted
    step = STEP / room if room > 0.0 else 1.0
    for count in range(1, int(1.0 / step) + 1):
        for share in (wanted + count * step, wanted - count * step):
            if 0.0 <= share <= 1.0:
                yield share
