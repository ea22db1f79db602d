"""Delta debugging: a subset of items from which no single one can be taken away.

It follows Zeller and Hildebrandt (*Simplifying and Isolating Failure-Inducing Input*, IEEE TSE
2002): chunks of halving size are taken away as long as the rest still passes the test. Proposals
are asked in an order, and the first that passes is taken, so that proposals may be tested at the
same time without any effect on the result.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence

Search = Generator[Sequence[frozenset[int]], int | None, frozenset[int]]
"""Yields ordered proposals, each the numbers of the items that are kept; is sent the place of the
first one that passes the test, or ``None`` if none does; returns the items that are kept."""


def minimal_subset(count: int) -> Search:
    """Searches a 1-minimal subset of items, of which all together pass the test.

    At its end the test was failed without any single one of the items that are kept.

    Args:
        count: Number of items.
    """
    if count == 0:
        return frozenset()
    # All at once first: if none of the items matters, one test shows it.
    if (yield [frozenset()]) is not None:
        return frozenset()
    # Only complements of chunks are tried. The other half of ddmin, each chunk alone, is left out:
    # 1-minimality rests on the last round only.
    kept = list(range(count))
    size = max(count // 2, 1)
    while True:
        has_progressed = False
        start = 0
        while start < len(kept):
            chunks = [kept[begin : begin + size] for begin in range(start, len(kept), size)]
            found = yield [frozenset(kept).difference(chunk) for chunk in chunks]
            if found is None:
                break
            # What comes before has just been tried, and is tried again in the next round.
            start += found * size
            del kept[start : start + size]
            has_progressed = True
        # A round of single items without progress has tried each of them against the same rest,
        # which is 1-minimality. After progress it has not: an item that was needed before may not
        # be needed any more.
        if size == 1 and not has_progressed:
            return frozenset(kept)
        size = max(size // 2, 1)
