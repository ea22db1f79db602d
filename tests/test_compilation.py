from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

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

_Y = int(Column.Y)

@compiled
def kernel(x):
    return _helped(x) + 100.0 * FACTOR + 1000.0 * _Y

@compiled
def _helped(x):
    return twice(x)

if __name__ == "__main__":
    import calling
    print(calling.kernel(1.0), sum(calling.kernel.stats.cache_hits.values()))
"""


@pytest.fixture
def modules(tmp_path: Path) -> Path:
    for name, text in (("called", CALLED), ("between", BETWEEN), ("calling", CALLING)):
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
    for old, new, value in (
        ("return FACTOR * x", "return 3.0 * x", "1209.0"),
        ("FACTOR = 2.0", "FACTOR = 4.0", "1409.0"),
        ("Y = 1", "Y = 2", "2409.0"),
    ):
        file = modules / "called.py"
        file.write_text(file.read_text().replace(old, new))
        assert outcome(modules) == f"{value} 0"
    assert outcome(modules) == "2409.0 1"
