from __future__ import annotations

import structlog
from structlog.testing import LogCapture

from drivora_service.fault_log import FaultLog


def test_a_fault_that_lasts_is_one_line_a_minute_and_says_what_was_left_out() -> None:
    lines, now = LogCapture(), [0.0]
    log = structlog.wrap_logger(structlog.PrintLogger(), processors=[lines])
    faults = FaultLog(log, clock=lambda: now[0])
    for tick in range(1200):
        now[0] = 0.1 * tick
        faults.error("disk_full", tick=tick)
        faults.error("locked")
    disk = [line for line in lines.entries if line["event"] == "disk_full"]
    assert [line.get("left_out", 0) for line in disk] == [0, 599]
    assert len(lines.entries) == 4

    faults.over("disk_full", "disk_has_space")
    faults.over("disk_full", "disk_has_space")
    faults.over("never_met", "never_said")
    assert [line["event"] for line in lines.entries[4:]] == ["disk_has_space"]
