from __future__ import annotations

from itertools import pairwise

from drivora_service.cli.terminal.log_pace import LogPace


def test_lines_become_rare() -> None:
    now = 0.0
    pace = LogPace(lambda: now)
    due = []
    for second in range(7200):
        now = float(second)
        if pace.is_due():
            due.append(second)
    assert due[:5] == [5, 15, 35, 75, 155]
    assert len(due) < 40
    assert max(after - before for before, after in pairwise(due)) == 300
