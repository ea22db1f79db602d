"""How many tests run at a time, by the processors and the memory that there are."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.load import GB, jobs, memory, processes


@pytest.mark.parametrize(
    ("gigabytes", "cores", "expected"),
    [(24, 2, (3, 2)), (8, 2, (3, 2)), (6, 2, (2, 2)), (4, 2, (1, 1)), (16, 16, (8, 2))],
)
def test_tests_have_room(gigabytes: float, cores: int, expected: tuple[int, int]) -> None:
    assert (processes(gigabytes * GB, cores), jobs(gigabytes * GB)) == expected


def test_there_is_always_one() -> None:
    assert (processes(0.5 * GB, 4), jobs(0.5 * GB)) == (1, 1)


@pytest.mark.parametrize(("limit", "expected"), [("400000000", 0.4 * GB), ("max", None)])
def test_the_limit_of_a_container_counts(
    tmp_path: Path, limit: str, expected: float | None
) -> None:
    file = tmp_path / "memory.max"
    file.write_text(f"{limit}\n")
    everything = memory([tmp_path / "gone"])
    found = memory([tmp_path / "gone", file])
    assert found == (everything if expected is None else min(expected, everything))
