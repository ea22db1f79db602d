"""Compiling the numeric kernels of the step loop to machine code."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar, cast

from numba import config, njit

# Before anything is compiled: results do not depend on what a machine's processor can do, and what
# one process has compiled all others find on the disk.
vars(config).update(CPU_NAME="generic", CPU_FEATURES="")

Function = TypeVar("Function", bound=Callable[..., object])


def compiled(function: Function) -> Function:
    """Compiles a function on its first call and keeps the result on disk.

    No fast-math: results must not depend on the order in which the compiler likes to add. Division
    by zero gives an infinity, as in NumPy.
    """
    return cast("Function", njit(cache=True, error_model="numpy")(function))
