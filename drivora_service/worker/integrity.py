"""Detection of changes to the code that simulates and judges since the process started.

An agent in process can reach all of it. A change, deliberate or by a library that it loads, must
not affect a verdict of its own run or of a later one without being detected.
"""

from __future__ import annotations

import builtins
import decimal
import locale
import sys
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from itertools import chain
from operator import attrgetter, is_, itemgetter
from types import ModuleType
from typing import Any

import numpy as np

from drivora_service.worker.watched import Names, Uses, Watched, WatchedKernel, collect

_MAX_NAMED = 5
"""Number of changes that a message names; the others are counted."""

_ADDED_ON_USE = frozenset(
    {
        "__abstractmethods__", "__annotations__", "__doc__", "__hash__",
        "__non_callable_proto_members__", "__protocol_attrs__", "__signature__",
    }
)  # fmt: skip
"""Names that the interpreter adds to classes on first use."""

_CODE = attrgetter("__code__")
_DEFAULTS = attrgetter("__defaults__")
_KEYWORD_DEFAULTS = attrgetter("__kwdefaults__")
_CONTENTS = attrgetter("cell_contents")

_SMALLEST_NORMAL = sys.float_info.min
_MISSING = object()


@dataclass(frozen=True, slots=True, kw_only=True)
class _State:
    """Settings of the interpreter and the processor that affect results."""

    numpy_errors: tuple[object, ...]
    recursion_limit: int
    fatal_warnings: tuple[object, ...]
    decimal_context: tuple[int, str]
    numeric_locale: str
    denormals: bool
    rounding: tuple[float, float, float]


_STATE_NAMES = {
    "numpy_errors": "NumPy's handling of floating-point errors (np.seterr)",
    "recursion_limit": "the recursion limit (sys.setrecursionlimit)",
    "fatal_warnings": "the filters that turn warnings into errors (warnings.filters)",
    "decimal_context": "the context of decimal arithmetic",
    "numeric_locale": "the locale",
    "denormals": "how the processor treats denormal numbers (flush to zero)",
    "rounding": "how the processor rounds",
}


class Snapshot:
    """The loaded code at one moment, to compare with.

    Attributes:
        has_met_others: Whether agents, oracles or feedbacks of other packages have run in this
            process. They may have left threads, which can change code at any time.
    """

    def __init__(self) -> None:
        self.has_met_others = False
        self._builtins = tuple(vars(builtins).items())
        self._tools = (all, map, is_, itemgetter, attrgetter, chain)
        self._state = _state()
        self._take(collect())

    def _take(self, watched: Watched) -> None:
        self._watched = watched
        # Views show the contents of a mapping at the time of reading.
        self._views = tuple(names.space.values() for names in watched.names)
        self._lengths = tuple(map(len, self._views))
        self._values = tuple(chain.from_iterable(names.values for names in watched.names))
        self._getters: tuple[tuple[Uses, Callable[[Any], Any]], ...] = tuple(
            # With one key it would return the value itself: the key twice makes it a tuple.
            (uses, itemgetter(*uses.keys, uses.keys[0]))
            for uses in watched.uses
        )

    def changes(self) -> tuple[str, ...]:
        """Returns descriptions of the changes since; empty if there are none.

        New names that change nothing, such as modules that were loaded later, are compared from the
        next call on.
        """
        # In plain statements, since everything below depends on these functions.
        space = vars(builtins)
        for name, value in self._builtins:
            if space.get(name, _MISSING) is not value:
                return (f"builtins.{name}",)
        if any(is_new for is_new in map(_is_not, self._tools, _tools())):
            return ("the functions of the modules operator and itertools",)
        found: list[str] = []
        grown = self._watched.modules != len(sys.modules)
        if self._lengths != tuple(map(len, self._views)) or not all(
            map(is_, chain.from_iterable(self._views), self._values)
        ):
            grown = True
            found += chain.from_iterable(map(_changed_names, self._watched.names))
        for uses, get in self._getters:
            try:
                if all(map(is_, get(uses.space), uses.values)):
                    continue
            except KeyError:
                pass
            found += [
                f"{uses.owner}.{key}"
                for key, value in zip(uses.keys, uses.values, strict=True)
                if uses.space.get(key, _MISSING) is not value
            ]
        found += _changed_functions(self._watched)
        found += [
            f"the kernel {_full_name(kernel.source)}"
            for kernel in self._watched.kernels
            if not _is_as_compiled(kernel)
        ]
        found += [
            owner
            for owner, table, items in self._watched.lists
            if len(table) != len(items) or not all(map(is_, table, items))
        ]
        if (now := _state()) != self._state:
            found += [
                said
                for name, said in _STATE_NAMES.items()
                if getattr(now, name) != getattr(self._state, name)
            ]
        if grown and not found:
            self._take(collect())
        return tuple(found)


@lru_cache(maxsize=1)
def snapshot_judging_code() -> Snapshot:
    """Returns this process's snapshot; the first call takes it."""
    return Snapshot()


def describe_code_changes(changes: tuple[str, ...], by: str) -> str:
    """Returns the message for a run in which an agent or plug-in changed the judging code.

    Args:
        changes: Descriptions of the changes; never empty.
        by: The agent or plug-in that made them.
    """
    named = ", ".join(changes[:_MAX_NAMED])
    more = f" and {len(changes) - _MAX_NAMED} more" if len(changes) > _MAX_NAMED else ""
    return (
        f"{by} changed what simulates and judges runs: {named}{more}. Nothing of it may be "
        "changed by code in the worker process: change copies, or run the agent in a process of "
        "its own"
    )


def _tools() -> tuple[object, ...]:
    return (all, map, is_, itemgetter, attrgetter, chain)


def _is_not(one: object, other: object) -> bool:
    return one is not other


def _changed_names(names: Names) -> Iterator[str]:
    for key, value in zip(names.keys, names.values, strict=True):
        if names.space.get(key, _MISSING) is not value:
            yield f"{names.owner}.{key}"
    for key in names.space.keys() - set(names.keys):
        if _counts(names, key):
            yield f"{names.owner}.{key}"


def _counts(names: Names, key: object) -> bool:
    """Returns whether a new name may change the effect of the others."""
    if not isinstance(key, str) or isinstance(names.space[key], ModuleType):
        return not isinstance(names.space[key], ModuleType)
    if names.is_closed:
        return key not in _ADDED_ON_USE and not key.startswith(("__pydantic_", "_abc_"))
    # Loaded code uses a new name only where it hides a built-in one.
    return names.owner != "builtins" and hasattr(builtins, key) and not key.startswith("__")


def _changed_functions(watched: Watched) -> Iterator[str]:
    for functions, read, then, what in (
        (watched.functions, _CODE, watched.codes, "code"),
        (watched.with_defaults, _DEFAULTS, watched.defaults, "defaults"),
        (
            watched.with_keyword_defaults,
            _KEYWORD_DEFAULTS,
            watched.keyword_defaults,
            "keyword defaults",
        ),
    ):
        if not all(map(is_, map(read, functions), then)):
            yield from (
                f"the {what} of {_full_name(function)}"
                for function, value in zip(functions, then, strict=True)
                if read(function) is not value
            )
    try:
        if all(map(is_, map(_CONTENTS, watched.cells), watched.contents)):
            return
    except ValueError:
        pass
    for function, cell, content in zip(
        watched.cell_owners, watched.cells, watched.contents, strict=True
    ):
        try:
            same = cell.cell_contents is content
        except ValueError:
            same = False
        if not same:
            yield f"what {_full_name(function)} encloses"


def _is_as_compiled(watched: WatchedKernel) -> bool:
    kernel = watched.kernel
    if kernel.function is not watched.source:
        return False
    if not kernel.is_loaded:
        return watched.dispatcher is None
    dispatcher = kernel.dispatcher
    if watched.dispatcher is None:
        return getattr(dispatcher, "py_func", None) is watched.source
    return (
        dispatcher is watched.dispatcher
        and dispatcher.py_func is watched.source
        # Looking up machine code by signature costs more than all other checks together.
        and len(dispatcher.overloads) >= watched.signatures
    )


def _full_name(function: Any) -> str:
    return f"{function.__module__}.{function.__qualname__}"


def _state() -> _State:
    context = decimal.getcontext()
    denormal = _half(_SMALLEST_NORMAL)
    return _State(
        numpy_errors=tuple(np.geterr().items()),
        recursion_limit=sys.getrecursionlimit(),
        # The other settings affect printing, and packages set them during import.
        fatal_warnings=tuple(item for item in warnings.filters if item[0] == "error"),
        decimal_context=(context.prec, context.rounding),
        numeric_locale=locale.setlocale(locale.LC_NUMERIC),
        # Compared as a normal number: a denormal one may count as zero in comparisons too.
        denormals=denormal + denormal == _SMALLEST_NORMAL,
        rounding=(_sum(1.0, 1e-17), _sum(-1.0, -1e-17), _sum(1.0, 1.7e-16)),
    )


def _half(number: float) -> float:
    return number * 0.5


def _sum(one: float, other: float) -> float:
    """Adds at run time; the compiler would fold constants."""
    return one + other
