"""Elementary functions of arrays: the bits of the C library, with the compiler and without."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from collections.abc import Callable

import numpy as np
import pytest

from drivora_service.compilation import load_compiler
from drivora_service.geometry import elementary
from drivora_service.geometry.array_shapes import FloatArray

FUNCTIONS: dict[str, tuple[Callable[[FloatArray], FloatArray], Callable[[float], float]]] = {
    "sin": (elementary.sin, math.sin),
    "cos": (elementary.cos, math.cos),
    "tan": (elementary.tan, math.tan),
    "arctan": (elementary.arctan, math.atan),
    "exp": (elementary.exp, math.exp),
    "tanh": (elementary.tanh, math.tanh),
}

WITHOUT_THE_COMPILER = """
import json, sys
import numpy as np
from drivora_service.geometry import elementary

values = np.array(json.load(sys.stdin))
found = {name: getattr(elementary, name)(values).tolist() for name in sys.argv[1:]}
found["arctan2"] = elementary.arctan2(values, values[::-1]).tolist()
assert "numba" not in sys.modules
print(json.dumps(found))
"""


def numbers() -> FloatArray:
    """Numbers of many magnitudes, each of both signs."""
    random = np.random.default_rng(3)
    sizes = np.concatenate(
        (random.uniform(0.0, 10.0, 3000), 10.0 ** random.uniform(-300.0, 2.5, 3000), [0.0])
    )
    return np.concatenate((sizes, -sizes))


@pytest.mark.parametrize("name", FUNCTIONS)
@pytest.mark.parametrize("count", [1, 8, 9, 12_002])
def test_each_number_is_that_of_the_c_library(name: str, count: int) -> None:
    load_compiler()
    of_arrays, of_numbers = FUNCTIONS[name]
    values = numbers()[-count:]
    assert of_arrays(values).tolist() == [of_numbers(value) for value in values.tolist()]


@pytest.mark.parametrize("count", [1, 8, 9, 12_002])
def test_directions_are_those_of_the_c_library(count: int) -> None:
    load_compiler()
    y, x = numbers()[-count:], np.random.default_rng(4).permutation(numbers())[-count:]
    assert elementary.arctan2(y, x).tolist() == [*map(math.atan2, y.tolist(), x.tolist())]


def test_a_process_without_the_compiler_computes_the_same() -> None:
    load_compiler()
    values = numbers()
    ended = subprocess.run(
        [sys.executable, "-c", WITHOUT_THE_COMPILER, *FUNCTIONS],
        input=json.dumps(values.tolist()),
        capture_output=True,
        text=True,
        check=True,
    )
    found = json.loads(ended.stdout)
    expected = {name: of_arrays(values).tolist() for name, (of_arrays, _) in FUNCTIONS.items()}
    expected["arctan2"] = elementary.arctan2(values, values[::-1]).tolist()
    assert found == expected


@pytest.mark.parametrize("count", [1, 100])
def test_what_math_refuses_is_nan_or_infinite(count: int) -> None:
    load_compiler()
    infinite = np.full(count, np.inf)
    for function in (elementary.sin, elementary.cos, elementary.tan):
        assert np.isnan(function(infinite)).all()
        assert np.isnan(function(-infinite)).all()
    assert (elementary.exp(np.full(count, 800.0)) == np.inf).all()
    assert (elementary.exp(-infinite) == 0.0).all()
    assert (elementary.tanh(infinite) == 1.0).all()
    for of_arrays, _ in FUNCTIONS.values():
        assert np.isnan(of_arrays(np.full(count, np.nan))).all()


def test_arrays_keep_their_shape_whatever_their_layout() -> None:
    load_compiler()
    table = numbers()[:120].reshape(4, 30)
    for values in (table, table.T, table[:, ::2], table[:0], table.reshape(2, 2, 30)):
        found = elementary.cos(values)
        assert found.shape == values.shape
        assert found.ravel().tolist() == [math.cos(value) for value in values.ravel().tolist()]


def test_directions_of_other_shapes_are_refused() -> None:
    with pytest.raises(ValueError, match=r"found shapes \(3,\) and \(1,\); they must be equal"):
        elementary.arctan2(np.ones(3), np.ones(1))
