"""The system's data on processes."""

from __future__ import annotations

import os
import subprocess
import sys
import threading

import pytest

from drivora_service.worker.process_readings import (
    children_of,
    list_children,
    read_last_pid,
    read_process,
)

LINUX = pytest.mark.skipif(sys.platform != "linux", reason="/proc is Linux's")


@LINUX
def test_children_are_listed_while_they_live() -> None:
    with subprocess.Popen(["sleep", "60"]) as child:
        reading = read_process(child.pid)
        assert reading is not None
        assert reading.name == "sleep" or reading.name.startswith("python")
        assert child.pid in children_of(os.getpid())
        assert child.pid in (list_children(os.getpid()) or ())
        assert list_children(child.pid) == []
        child.kill()


@LINUX
def test_nothing_is_listed_of_a_process_that_has_ended() -> None:
    with subprocess.Popen(["true"]) as child:
        child.wait()
        # Unlike the empty list of a process that has started none.
        assert list_children(child.pid) is None
        assert children_of(child.pid) == []
        assert read_process(child.pid) is None


@LINUX
def test_every_process_and_thread_that_starts_is_counted() -> None:
    before = read_last_pid()
    if before is None:
        pytest.skip("the system does not tell its last process id")
    subprocess.run(["true"], check=True)
    after_process = read_last_pid()
    thread = threading.Thread(target=int)
    thread.start()
    thread.join()
    assert len({before, after_process, read_last_pid()}) == 3
