"""The code that simulates and judges runs, collected so that changes to it can be detected.

By identity, and shallow: the names of every loaded module of the rooms that simulate and judge and
of the classes there, the code and defaults of their functions, compiled kernels, tables, and the
functions of other packages that those rooms use (``np.hypot``, ``math.atan2``, ``json.dumps`` …)
with the functions behind them.
"""

from __future__ import annotations

import builtins
import inspect
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from types import CellType, CodeType, FunctionType, ModuleType
from typing import Any

from drivora_service.compilation import Kernel

_PACKAGE = "drivora_service"
_ROOMS = frozenset(
    {
        "agents", "compilation", "errors", "feedback", "geometry", "metrics", "networks",
        "observations", "oracles", "parameters", "plugin_table", "runs", "scenario", "simulation",
        "shapes", "worker",
    }
)  # fmt: skip
_CHANGING = frozenset({"sys", "threading", "warnings", "numba.core.config"})
"""Modules that the interpreter, or their own package, changes during normal work."""

_FOREIGN_DEPTH = 2
"""Depth to which names of other packages are followed: ``np.clip`` is a function of another module
of NumPy, which uses helpers of a third."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Names:
    """The names of a module, a class or a table, and their values when collected.

    Attributes:
        owner: Name for messages.
        space: The live mapping.
        keys: Its keys, in their order when collected.
        values: Values of the keys.
        is_closed: Whether a new name counts as a change, as one may hide an inherited one.
    """

    owner: str
    space: Mapping[Any, object]
    keys: tuple[Any, ...]
    values: tuple[object, ...]
    is_closed: bool = False


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Uses:
    """Names of a module of another package that the watched code uses.

    Attributes:
        owner: The module's name.
        space: Its live mapping.
        keys: The used names; never empty.
        values: Their values when collected.
    """

    owner: str
    space: Mapping[str, object]
    keys: tuple[str, ...]
    values: tuple[object, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class WatchedKernel:
    """A compiled function.

    Attributes:
        kernel: The kernel.
        source: Python function from which it is compiled.
        dispatcher: Its dispatcher; ``None`` if it had not been called when it was collected.
        signatures: Number of compiled signatures; more may follow.
    """

    kernel: Kernel
    source: Callable[..., Any]
    dispatcher: Any
    signatures: int


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Watched:
    """The compared objects, by kind; corresponding tuples have the same order.

    Attributes:
        modules: Number of loaded modules when it was collected.
        codes: Code objects of ``functions``.
        with_defaults: The functions with defaults; calls of the others pass every argument.
        with_keyword_defaults: The same for arguments by keyword.
        cells: Variables of closures.
        contents: Their contents when collected.
        cell_owners: The functions that they belong to.
        lists: Tables that are lists, and their contents when collected.
    """

    modules: int
    names: tuple[Names, ...]
    uses: tuple[Uses, ...]
    functions: tuple[FunctionType, ...]
    codes: tuple[CodeType, ...]
    with_defaults: tuple[FunctionType, ...]
    defaults: tuple[object, ...]
    with_keyword_defaults: tuple[FunctionType, ...]
    keyword_defaults: tuple[object, ...]
    kernels: tuple[WatchedKernel, ...]
    cells: tuple[CellType, ...]
    contents: tuple[object, ...]
    cell_owners: tuple[FunctionType, ...]
    lists: tuple[tuple[str, list[object], tuple[object, ...]], ...]


def collect() -> Watched:
    """Collects the loaded code; takes some fifty milliseconds."""
    own = [module for name, module in sorted(sys.modules.items()) if _is_watched(name)]
    names = [_names("builtins", vars(builtins))]
    found = _Found()
    for module in own:
        names.append(_names(module.__name__, vars(module)))
        for key, value in vars(module).items():
            if key.startswith("__"):
                continue
            owner = f"{module.__name__}.{key}"
            if isinstance(value, type):
                if value.__module__ == module.__name__:
                    names.append(_names(owner, vars(value), is_closed=True))
                    for attribute in vars(value).values():
                        found.add(attribute)
            elif type(value) is dict:
                names.append(_names(owner, value, is_closed=True))
            elif type(value) is list:
                found.lists.append((owner, value, tuple(value)))
            else:
                found.add(value)
    uses = tuple(_uses(own, found))
    functions = tuple(found.functions.values())
    with_defaults = tuple(f for f in functions if f.__defaults__)
    with_keyword_defaults = tuple(f for f in functions if f.__kwdefaults__)
    closures = [(f, cell) for f in functions for cell in f.__closure__ or () if _is_filled(cell)]
    return Watched(
        modules=len(sys.modules),
        names=tuple(names),
        uses=uses,
        functions=functions,
        codes=tuple(f.__code__ for f in functions),
        with_defaults=with_defaults,
        defaults=tuple(f.__defaults__ for f in with_defaults),
        with_keyword_defaults=with_keyword_defaults,
        keyword_defaults=tuple(f.__kwdefaults__ for f in with_keyword_defaults),
        kernels=tuple(_kernel(kernel) for kernel in found.kernels.values()),
        cells=tuple(cell for _, cell in closures),
        contents=tuple(cell.cell_contents for _, cell in closures),
        cell_owners=tuple(function for function, _ in closures),
        lists=tuple(found.lists),
    )


def _kernel(kernel: Kernel) -> WatchedKernel:
    dispatcher = kernel.dispatcher if kernel.is_loaded else None
    return WatchedKernel(
        kernel=kernel,
        source=kernel.function,
        dispatcher=dispatcher,
        signatures=0 if dispatcher is None else len(dispatcher.overloads),
    )


def _is_watched(module: str) -> bool:
    package, _, rest = module.partition(".")
    return package == _PACKAGE and rest.partition(".")[0] in _ROOMS


class _Found:
    """Functions and kernels, each once, and lists."""

    def __init__(self) -> None:
        self.functions: dict[int, FunctionType] = {}
        self.kernels: dict[int, Kernel] = {}
        self.lists: list[tuple[str, list[object], tuple[object, ...]]] = []

    def add(self, value: object) -> None:
        """Adds the functions behind a value: of a method, a property, a cache, a kernel."""
        if isinstance(value, Kernel):
            self.kernels[id(value)] = value
            value = value.function
        match value:
            case staticmethod() | classmethod():
                value = value.__func__
            case property():
                for accessor in (value.fget, value.fset):
                    self.add(accessor)
                return
            case cached_property():
                value = value.func
        if callable(value) and not isinstance(value, type):
            while not isinstance(value, FunctionType) and hasattr(value, "__wrapped__"):
                value = value.__wrapped__
        if isinstance(value, FunctionType):
            self.functions.setdefault(id(value), value)


def _uses(own: Iterable[ModuleType], found: _Found) -> Iterator[Uses]:
    """Yields the used names of other packages; adds the functions behind them to ``found``."""
    used = {name for function in found.functions.values() for name in _names_in(function.__code__)}
    known = {id(module) for module in own}
    level = [value for m in own for value in vars(m).values() if isinstance(value, ModuleType)]
    for _ in range(_FOREIGN_DEPTH + 1):
        behind: list[ModuleType] = []
        more: set[str] = set()
        for module in level:
            if id(module) in known or module.__name__ in _CHANGING:
                continue
            known.add(id(module))
            space = vars(module)
            keys = tuple(sorted(key for key in used & space.keys() if not key.startswith("__")))
            if not keys:
                continue
            values = tuple(space[key] for key in keys)
            yield Uses(owner=module.__name__, space=space, keys=keys, values=values)
            package = module.__name__.partition(".")[0]
            for value in values:
                helper = value if isinstance(value, ModuleType) else None
                if (function := _behind(value)) is not None:
                    found.functions.setdefault(id(function), function)
                    more.update(_names_in(function.__code__))
                    helper = sys.modules.get(str(function.__globals__.get("__name__")))
                if helper is not None and helper.__name__.partition(".")[0] == package:
                    behind.append(helper)
        level = behind
        used |= more


def _behind(value: object) -> FunctionType | None:
    if isinstance(value, type) or not callable(value):
        return None
    function = inspect.unwrap(value) if hasattr(value, "__wrapped__") else value
    return function if isinstance(function, FunctionType) else None


def _names_in(code: CodeType) -> Iterator[str]:
    yield from code.co_names
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _names_in(constant)


def _names(owner: str, space: Mapping[Any, object], *, is_closed: bool = False) -> Names:
    keys = tuple(space)
    return Names(
        owner=owner,
        space=space,
        keys=keys,
        values=tuple(space.values()),
        is_closed=is_closed,
    )


def _is_filled(cell: CellType) -> bool:
    try:
        cell.cell_contents  # noqa: B018 # raises if the cell is empty
    except ValueError:
        return False
    return True
