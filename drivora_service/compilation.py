"""Compiling the numeric kernels of the step loop to machine code."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar, cast

from numba import njit

Function = TypeVar("Function", bound=Callable[..., object])


def compiled(function: Function) -> Function:
    """Compiles a function on its first call and keeps the result on disk.

    No fast-math: results must not depend on the order in which the compiler likes to add. Division
    by zero gives an infinity, as in NumPy.
    """
    return cast("Function", njit(cache=True, error_model="numpy")(function))


@compiled
def compiler_ready() -> bool:
    """Gives true; the first call of any compiled function makes numba load what it knows."""
    return True
