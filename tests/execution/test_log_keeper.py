"""Logs of workers that print without end stay short."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Callable
from pathlib import Path

from drivora_service.execution.log_keeper import LogKeeper
from drivora_service.execution.worker_log import WorkerLog

LONGEST = 1 << 20


def until(condition: Callable[[], bool]) -> None:
    deadline = time.monotonic() + 30.0
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.01)


def test_logs_are_cut_while_they_are_written(tmp_path: Path) -> None:
    before = set(threading.enumerate())
    logs = [WorkerLog(tmp_path / f"{number}.log", longest=LONGEST) for number in range(2)]
    files = [log.open() for log in logs]
    keeper = LogKeeper(lambda: logs)
    try:
        os.write(files[0], b"x" * (3 * LONGEST) + b"\nlast words\n")
        until(lambda: os.fstat(files[0]).st_size < LONGEST)
        assert logs[0].tail().endswith("last words")
        os.write(files[1], b"short\n")
        # What cannot be cut keeps no other from being cut.
        os.close(files[0])
        os.write(files[1], b"y" * (3 * LONGEST))
        until(lambda: os.fstat(files[1]).st_size < LONGEST)
    finally:
        keeper.close()
    logs[1].close()
    begun = set(threading.enumerate()) - before
    assert not any(thread.name == "log-keeper" for thread in begun)


def test_logs_that_grow_are_looked_at_more_often(tmp_path: Path) -> None:
    log = WorkerLog(tmp_path / "one.log", longest=LONGEST)
    file = log.open()
    keeper = LogKeeper(lambda: [log])
    keeper.close()
    quiet = keeper.look()
    for _ in range(3):
        # Each time it is cut to the same size.
        os.write(file, b"x" * (3 * LONGEST))
        assert keeper.look() < quiet
    os.write(file, b"a line")
    assert keeper.look() == quiet
    log.close()
