from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from drivora_service.execution.pace import Pace


@given(slots=st.integers(1, 64), seconds=st.lists(st.floats(0, 1e4), max_size=50))
def test_every_slot_has_a_next_run_and_urgent_ones_wait_for_few(
    slots: int, seconds: list[float]
) -> None:
    pace = Pace()
    for duration in seconds:
        pace.note(duration)
    assert 2 * slots <= pace.target_in_flight(slots) <= 17 * slots


def test_short_runs_are_held_ready_in_number_and_long_ones_are_not() -> None:
    short, long = Pace(), Pace()
    for _ in range(50):
        short.note(0.1)
        long.note(20.0)
    assert short.target_in_flight(2) == 18
    assert long.target_in_flight(2) == 4
