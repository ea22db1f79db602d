"""The wall clock of the server jumps while runs are going on."""

from __future__ import annotations

import shutil
import time
from pathlib import Path

import pytest

from tests.faults import jumping_clock
from tests.faults.conftest import Judge
from tests.faults.processes import wait_until
from tests.faults.service_under_test import Service, install_agents
from tests.faults.work import good_runs


@pytest.mark.parametrize("hours", [1, -1], ids=["forward", "backward"])
def test_the_clock_jumps_by_an_hour(
    own_service: Service, check: Judge, tmp_path: Path, hours: int, trial: int
) -> None:
    service = own_service
    install_agents(service.site)
    service.evidence.mkdir()
    shutil.copy(jumping_clock.__file__, service.site / "sitecustomize.py")
    offset = tmp_path / "offset"
    service.variables = {jumping_clock.VARIABLE: str(offset)}
    service.start()
    work = service.post(good_runs(16))
    service.wait_until_ended(work, 5)
    offset.write_text(str(3600 * hours))
    time.sleep(3.0)
    offset.write_text("0")
    check(service, work)
    assert len(service.query("SELECT id FROM owners")) == 1
    # The last beat may still have the wrong time; the next one has the right one.
    wait_until(
        lambda: bool(service.query("SELECT id FROM owners WHERE heartbeat_at > started_at")),
        seconds=30.0,
        what="the server's heartbeat stays before its start",
    )
