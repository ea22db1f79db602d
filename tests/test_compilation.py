from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from drivora_service.compilation import compiled, interpreted_kernels, specialize
from drivora_service.geometry.array_shapes import FloatArray

RECORD = """
from typing import NamedTuple

class Pair(NamedTuple):
    one: float
    two: float
"""
CALLED = """
from enum import IntEnum
from drivora_service.compilation import compiled

FACTOR = 2.0

class Column(IntEnum):
    X = 0
    Y = 1

@compiled
def scaled(x):
    return FACTOR * x
"""
BETWEEN = """
from drivora_service.compilation import compiled
from called import scaled

@compiled
def twice(x):
    return scaled(scaled(x))
"""
CALLING = """
from drivora_service.compilation import compiled
from between import twice
from called import FACTOR, Column
from record import Pair

_Y = int(Column.Y)

@compiled
def kernel(x: Pair):
    return _helped(x.one) + 100.0 * FACTOR + 1000.0 * _Y

@compiled
def _helped(x):
    return twice(x)

if __name__ == "__main__":
    import calling
    result = calling.kernel(Pair(one=1.0, two=3.0))
    print(result, sum(calling.kernel.dispatcher.stats.cache_hits.values()))
"""


@pytest.fixture
def modules(tmp_path: Path) -> Path:
    texts = {"record": RECORD, "called": CALLED, "between": BETWEEN, "calling": CALLING}
    for name, text in texts.items():
        (tmp_path / f"{name}.py").write_text(text)
    return tmp_path


def outcome(modules: Path) -> str:
    command = [sys.executable, "calling.py"]
    return subprocess.run(
        command, cwd=modules, check=True, capture_output=True, text=True
    ).stdout.strip()


@pytest.mark.slow
def test_what_is_kept_of_a_kernel_goes_with_what_it_was_compiled_from(modules: Path) -> None:
    assert outcome(modules) == "1204.0 0"
    assert outcome(modules) == "1204.0 1"
    for module, old, new, value in (
        ("called", "return FACTOR * x", "return 3.0 * x", "1209.0"),
        ("called", "FACTOR = 2.0", "FACTOR = 4.0", "1409.0"),
        ("called", "Y = 1", "Y = 2", "2409.0"),
        ("record", "one: float\n    two", "two: float\n    one", "2409.0"),
    ):
        file = modules / f"{module}.py"
        file.write_text(file.read_text().replace(old, new))
        assert outcome(modules) == f"{value} 0"
    assert outcome(modules) == "2409.0 1"


@compiled
def _added(values: FloatArray, more: float) -> float:
    return float(values.sum() + more)


def test_the_machine_code_of_a_kernel_is_called_directly_while_it_has_one_version() -> None:
    assert specialize(_added) is _added
    values = np.array([1.0, 2.0, 3.0, 4.0])
    assert _added(values, 0.5) == 10.5
    direct = specialize(_added)
    assert direct is not _added
    assert direct(values, 4.0) == 14.0
    assert _added(values[::2], 0.5) == 4.5
    assert specialize(_added) is _added
    assert direct(values, 4.0) == 14.0


LIGHT = """
import sys
from called import scaled
from drivora_service.compilation import kernel, load_compiler, worth_loading

kernel._FEW = 5
print([worth_loading(scaled, 2) for _ in range(3)], "numba" in sys.modules)
load_compiler()
scaled.spared = 0
print(worth_loading(scaled, 1), "numba" in sys.modules)
"""


def test_a_kernel_is_not_worth_loading_the_compiler_for_a_few_calls(modules: Path) -> None:
    ended = subprocess.run(
        [sys.executable, "-c", LIGHT], cwd=modules, check=True, capture_output=True, text=True
    )
    assert ended.stdout.splitlines() == ["[False, False, True] False", "True True"]


def test_interpreted_kernels_compile_nothing() -> None:
    @compiled
    def halved(x: float) -> float:
        return x / 2.0

    with interpreted_kernels():
        assert halved(3.0) == 1.5
        assert specialize(halved) is halved
    assert not halved.is_loaded  # type: ignore[attr-defined] # a kernel
    assert halved(3.0) == 1.5
    assert halved.is_loaded  # type: ignore[attr-defined]  # a compiled function has it
