"""Layers of small neural networks in float32, with the same bits on every processor.

BLAS, by which NumPy multiplies matrices, adds in another order on each kind of processor, with or
without fused operations. Here each element of a product is the sum of its terms in their order;
the elements of a row are computed side by side.
"""

from __future__ import annotations

import math

import numpy as np

from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import Float32Array


def product(rows: Float32Array, weights: Float32Array) -> Float32Array:
    """Returns the product of a vector (k,) or of rows (n, k) with a matrix (k, m)."""
    table = np.ascontiguousarray(rows).reshape(-1, weights.shape[0])
    found = np.zeros((len(table), weights.shape[1]), dtype=np.float32)
    _add_product(table, np.ascontiguousarray(weights), found)
    return found if rows.ndim > 1 else found.reshape(-1)


def products(left: Float32Array, right: Float32Array) -> Float32Array:
    """Returns the products (h, n, m) of h matrices (h, n, k) with h matrices (h, k, m)."""
    found = np.zeros((left.shape[0], left.shape[1], right.shape[2]), dtype=np.float32)
    _add_products(np.ascontiguousarray(left), np.ascontiguousarray(right), found)
    return found


def exp32(values: Float32Array) -> Float32Array:
    """Returns the powers of e of an array of any shape."""
    found = np.empty(values.shape, dtype=np.float32)
    _exponentials(np.ascontiguousarray(values).reshape(-1), found.reshape(-1))
    return found


def tanh32(values: Float32Array) -> Float32Array:
    """Returns the hyperbolic tangents of an array of any shape."""
    found = np.empty(values.shape, dtype=np.float32)
    _hyperbolic_tangents(np.ascontiguousarray(values).reshape(-1), found.reshape(-1))
    return found


@compiled
def _add_product(rows: Float32Array, weights: Float32Array, out: Float32Array) -> None:
    """Adds a product of matrices (n, k) and (k, m); the terms of an element in the order of k."""
    # The innermost loops go along a row of `weights`, so that their additions are independent of
    # each other: they are vectorised without a change of the order within a sum. Four rows at a
    # time, so that `out` is read and written less often.
    inputs, outputs = weights.shape
    whole = inputs - inputs % 4
    for i in range(rows.shape[0]):
        for k in range(0, whole, 4):
            a, b, c, d = rows[i, k], rows[i, k + 1], rows[i, k + 2], rows[i, k + 3]
            for j in range(outputs):
                total = out[i, j] + a * weights[k, j]
                total = total + b * weights[k + 1, j]
                total = total + c * weights[k + 2, j]
                out[i, j] = total + d * weights[k + 3, j]
        for k in range(whole, inputs):
            for j in range(outputs):
                out[i, j] += rows[i, k] * weights[k, j]


@compiled
def _add_products(left: Float32Array, right: Float32Array, out: Float32Array) -> None:
    for h in range(left.shape[0]):
        _add_product(left[h], right[h], out[h])


@compiled
def _exponentials(values: Float32Array, out: Float32Array) -> None:
    # In float64, so that each number but very few is the nearest one with any C library.
    for i in range(values.shape[0]):
        out[i] = math.exp(np.float64(values[i]))


@compiled
def _hyperbolic_tangents(values: Float32Array, out: Float32Array) -> None:
    for i in range(values.shape[0]):
        out[i] = math.tanh(np.float64(values[i]))
