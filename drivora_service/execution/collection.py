"""The garbage collector of a process that takes runs."""

from __future__ import annotations

import gc

_NEW_OBJECTS = 50_000
"""Objects that are made, fewer those that are gone, before unreachable ones are sought: more than
the reports have that end between two transactions, so that those are gone before."""


def settle_garbage_collector() -> None:
    """Lets the garbage collector traverse neither permanent objects nor reports on their way.

    Nearly nothing in a report or a request refers to itself, so that it is freed without a search.
    Visiting permanent objects holds up every thread for a tenth of a second.
    """
    gc.collect()
    gc.freeze()
    gc.set_threshold(_NEW_OBJECTS)
