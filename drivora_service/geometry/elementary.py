"""Elementary functions of arrays with the same bits on every processor.

NumPy computes these functions with the widest instructions that it finds at run time: on
processors with AVX-512 by other code than elsewhere, whose last bits are others (float64: all but
the sine and the cosine; float32: those too, already with AVX2). Here they are functions of the C
library, called for one number at a time, as in compiled kernels and in ``math``. What decides a
trace, a verdict or a gene uses these; decision 73.

In a process with the compiler, arrays are computed by kernels, about as fast as by NumPy; in others
by ``math``, some 70 ns a number, with the same bits. Where ``math`` raises, they return what the C
library does: NaN or an infinity.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from drivora_service.compilation import compiled, is_compiler_loaded
from drivora_service.geometry.array_shapes import FloatArray


def sin(angles: FloatArray) -> FloatArray:
    """Returns the sines of angles in radians."""
    return _compute(_sines, math.sin, angles)


def cos(angles: FloatArray) -> FloatArray:
    """Returns the cosines of angles in radians."""
    return _compute(_cosines, math.cos, angles)


def tan(angles: FloatArray) -> FloatArray:
    """Returns the tangents of angles in radians."""
    return _compute(_tangents, math.tan, angles)


def arctan(slopes: FloatArray) -> FloatArray:
    """Returns the angles, in [-pi/2, pi/2], whose tangents are given."""
    return _compute(_arc_tangents, math.atan, slopes)


def arctan2(y: FloatArray, x: FloatArray) -> FloatArray:
    """Returns the directions, in [-pi, pi], of vectors (x, y); the arrays have the same shape."""
    if y.shape != x.shape:
        raise ValueError(f"found shapes {y.shape} and {x.shape}; they must be equal")
    if y.size <= _FEW or not is_compiler_loaded():
        results = [*map(math.atan2, y.ravel().tolist(), x.ravel().tolist())]
        return np.array(results, dtype=np.float64).reshape(y.shape)
    found = np.empty(y.shape)
    _directions(_flat(y), _flat(x), found.reshape(-1))
    return found


def exp(exponents: FloatArray) -> FloatArray:
    """Returns the powers of e."""
    return _compute(_exponentials, math.exp, exponents)


def tanh(values: FloatArray) -> FloatArray:
    """Returns the hyperbolic tangents."""
    return _compute(_hyperbolic_tangents, math.tanh, values)


_FEW = 8
"""Numbers that ``math`` computes as fast as a kernel is called."""

_Kernel = Callable[[FloatArray, FloatArray], None]
_Function = Callable[[float], float]


def _compute(kernel: _Kernel, function: _Function, values: FloatArray) -> FloatArray:
    """Returns a function of each of the values, by machine code if the compiler is loaded."""
    if values.size > _FEW and is_compiler_loaded():
        found = np.empty(values.shape)
        kernel(_flat(values), found.reshape(-1))
        return found
    numbers = values.ravel().tolist()
    try:
        results = [*map(function, numbers)]
    except (ValueError, OverflowError):
        results = [_compute_number(function, number) for number in numbers]
    return np.array(results, dtype=np.float64).reshape(values.shape)


def _compute_number(function: _Function, number: float) -> float:
    """Returns a function of a number, and what the C library returns where ``math`` raises."""
    try:
        return function(number)
    except ValueError:
        return math.nan
    except OverflowError:
        return math.inf


def _flat(values: FloatArray) -> FloatArray:
    """Returns the values as kernels take them: one after another, in float64."""
    return np.ascontiguousarray(values, dtype=np.float64).reshape(-1)


@compiled
def _sines(values: FloatArray, out: FloatArray) -> None:
    for i in range(values.shape[0]):
        out[i] = math.sin(values[i])


@compiled
def _cosines(values: FloatArray, out: FloatArray) -> None:
    for i in range(values.shape[0]):
        out[i] = math.cos(values[i])


@compiled
def _tangents(values: FloatArray, out: FloatArray) -> None:
    for i in range(values.shape[0]):
        out[i] = math.tan(values[i])


@compiled
def _arc_tangents(values: FloatArray, out: FloatArray) -> None:
    for i in range(values.shape[0]):
        out[i] = math.atan(values[i])


@compiled
def _directions(y: FloatArray, x: FloatArray, out: FloatArray) -> None:
    for i in range(y.shape[0]):
        out[i] = math.atan2(y[i], x[i])


@compiled
def _exponentials(values: FloatArray, out: FloatArray) -> None:
    for i in range(values.shape[0]):
        out[i] = math.exp(values[i])


@compiled
def _hyperbolic_tangents(values: FloatArray, out: FloatArray) -> None:
    for i in range(values.shape[0]):
        out[i] = math.tanh(values[i])
