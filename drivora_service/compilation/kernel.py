"""Functions that are compiled on their first call."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cached_property
from importlib import import_module
from typing import Any, TypeVar, cast

Function = TypeVar("Function", bound=Callable[..., object])

_MACHINE_CODE = "drivora_service.compilation.machine_code"
"""The module that imports the compiler."""

_FEW = 5000
"""Calls of a kernel that take about as long without machine code as loading the compiler."""

_interpreting = False


class Kernel:
    """A function that is compiled on its first call.

    Attributes:
        function: The Python function.
        spared: Calls that were done without it.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        """Compiles nothing yet."""
        self.function = function
        self.spared = 0
        self.__name__, self.__doc__ = function.__name__, function.__doc__
        self.__module__, self.__qualname__ = function.__module__, function.__qualname__

    @cached_property
    def dispatcher(self) -> Any:
        """Finds the machine code for the types of arguments; made on its first use."""
        # Imported here, as the compiler takes half a second that many processes do not need.
        from drivora_service.compilation.machine_code import dispatcher_of

        return dispatcher_of(self.function)

    @property
    def is_loaded(self) -> bool:
        """Whether there is a dispatcher."""
        return "dispatcher" in vars(self)

    @property
    def _numba_type_(self) -> Any:
        """The type by which other kernels call this one."""
        return self.dispatcher._numba_type_

    def __call__(self, *arguments: Any) -> Any:
        """Calls the machine code."""
        if _interpreting:
            return self.function(*arguments)
        return self.dispatcher(*arguments)


def compiled(function: Function) -> Function:
    """Compiles a function on its first call and keeps the result on disk.

    No fast-math: results must not depend on the compiler's order of additions. Division by zero
    gives an infinity, as in NumPy.
    """
    return cast("Function", Kernel(function))


@contextmanager
def interpreted_kernels() -> Iterator[None]:
    """Calls the Python functions of kernels meanwhile, in all threads of this process.

    A process that simulates one scenario on a machine without machine code is done in a few
    seconds, where the compiler alone takes half a minute. The last bits of results may differ from
    those of machine code, and a division by zero raises: they are for a first look only.
    """
    global _interpreting
    _interpreting = True
    try:
        yield
    finally:
        _interpreting = False


def specialize(kernel: Function) -> Function:
    """Returns a faster way to call a kernel with arguments of the same types as in its last call.

    A kernel finds its machine code by the types of all arguments, which takes a microsecond or more
    with twenty of them. Only the caller knows that its arguments keep their types: the machine code
    itself does not check them. A kernel that has been called with several combinations of types is
    returned as it is.
    """
    if _interpreting:
        return kernel
    # An ordered mapping hashes its keys to go through its values: the types of all arguments, which
    # takes as long as some steps.
    versions = list(dict.values(cast("Kernel", kernel).dispatcher.overloads))
    return cast("Function", versions[0].entry_point) if len(versions) == 1 else kernel


def worth_loading(kernel: Callable[..., object], calls: int) -> bool:
    """Returns whether to call a kernel rather than a function that returns the same without it.

    That is so in a process that has loaded the compiler, and after so many calls that loading it
    would have been faster.

    Args:
        kernel: A kernel.
        calls: How many calls of the function are about to be made instead.
    """
    if is_compiler_loaded():
        return True
    known = cast("Kernel", kernel)
    known.spared += calls
    return known.spared > _FEW


def is_compiler_loaded() -> bool:
    """Returns whether this process has the compiler, so that kernels are ready at once."""
    return _MACHINE_CODE in sys.modules


def load_compiler() -> None:
    """Loads the compiler, in a process that will call kernels often and must be ready for it."""
    import_module(_MACHINE_CODE)
