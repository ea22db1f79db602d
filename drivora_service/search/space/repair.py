"""Repair: moving actors that appear too near to one another, by changing their genes."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.search.space.actor_starts import Start, too_near

STEP = 2.0
"""Metres by which an actor is moved at a time."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Mover:
    """An actor with a start determined by genes.

    Attributes:
        start: Returns its appearance, from the values of all genes.
        room: Returns the metres by which the shift gene moves it from 0 to 1.
        shift_gene: Index of the gene that moves it.
        alternatives: Indices and values of genes to try one by one, in order, if it has no free
            place otherwise.
        is_refused: Whether a start is bad for another reason than actors near it.
    """

    start: Callable[[FloatArray], Start]
    room: Callable[[FloatArray], float]
    shift_gene: int
    alternatives: tuple[tuple[int, float], ...] = ()
    is_refused: Callable[[Start], bool] | None = None


def settle(values: FloatArray, mover: Mover, taken: list[Start]) -> None:
    """Moves an actor to the nearest free place, and adds its start to ``taken``.

    It is moved along its path, forwards and backwards in growing steps; if all of it is taken, each
    of its alternatives is tried. If no place is free, it is unchanged.

    Args:
        values: (d,) genes; those of the actor are changed.
        mover: The actor.
        taken: Starts of the other actors.
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
    """Changes the values from one place to the next, and yields each start."""
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
    """Yields shares of a room in metres, first the wanted one, then at growing distances."""
    yield wanted
    step = STEP / room if room > 0.0 else 1.0
    for count in range(1, int(1.0 / step) + 1):
        for share in (wanted + count * step, wanted - count * step):
            if 0.0 <= share <= 1.0:
                yield share
