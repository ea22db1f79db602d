"""The limits of a campaign's process, on readings of the system."""

from __future__ import annotations

from pathlib import Path

import pytest

from drivora_service.campaigns.hosts.engine_limits import (
    CallBoard,
    EngineLimits,
    EngineWatch,
    read_board,
)
from drivora_service.campaigns.search.tester_calls import TesterCall
from drivora_service.worker.process_readings import ProcessReading

ASK, NONE = TesterCall.ASK, TesterCall.NONE
LIMITS = EngineLimits(memory_bytes=100 << 20, call_s=3.0)


def reading(state: str = "R", cpu_s: float = 0.0, mib: int = 50) -> ProcessReading:
    return ProcessReading(
        state=state, cpu_s=cpu_s, memory_bytes=mib << 20, started=1.0, name="python"
    )


def first_breach(state: str, cpu_share: float, calls: tuple[int, TesterCall] | None) -> float:
    """Returns the second at which a process is beyond its limits, of 20; infinity for never."""
    watch = EngineWatch(LIMITS, now=0.0)
    for half in range(1, 40):
        now = half / 2.0
        board = (half, ASK) if calls is None else calls
        if watch.check(reading(state, cpu_s=cpu_share * now), 0, board, now):
            return now
    return float("inf")


@pytest.mark.parametrize(
    ("state", "cpu_share", "calls", "expected"),
    [
        ("R", 1.0, (1, ASK), 4.0),
        ("S", 0.0, (1, ASK), 4.0),
        # It has half a processor, so that a call takes it twice as long.
        ("R", 0.5, (1, ASK), 7.0),
        # It is stopped, waits for a processor, calls again and again, or is not in a call.
        ("T", 0.0, (1, ASK), float("inf")),
        ("R", 0.0, (1, ASK), float("inf")),
        ("R", 1.0, None, float("inf")),
        ("S", 0.0, (7, NONE), float("inf")),
    ],
)
def test_the_own_time_of_one_call_counts(
    state: str, cpu_share: float, calls: tuple[int, TesterCall] | None, expected: float
) -> None:
    assert first_breach(state, cpu_share, calls) == expected


def test_memory_of_what_it_has_started_counts() -> None:
    watch = EngineWatch(LIMITS, now=0.0)
    assert watch.check(reading(mib=60), 40 << 20, (0, NONE), 0.5) == ""
    assert watch.check(reading(mib=60), 41 << 20, (0, NONE), 1.0).startswith(
        "its process grew to 101 MiB; 100 MiB are allowed. Choose smaller parameters, or raise "
    )


def test_the_supervisor_reads_what_the_engine_wrote(tmp_path: Path) -> None:
    path = tmp_path / "engine.call"
    assert read_board(path) == (0, NONE)
    board = CallBoard(path)
    board.write(ASK)
    assert read_board(path) == (2, ASK)
    path.write_bytes(b"\xff" * 16)
    assert read_board(path)[1] is NONE
