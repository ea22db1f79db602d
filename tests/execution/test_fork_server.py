"""Starts of processes from a fork server that was lost."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

# In a process of its own: other tests have processes of this one's fork server.
_PROGRAM = """
import os, socket, sys
from multiprocessing import forkserver
from drivora_service.execution.fork_server import prepare_processes, start_process

def work(place):
    with open(place, "w") as file:
        file.write(str(os.getppid()))

def parent_of(place):
    process = start_process(work, (place,))
    process.join(60)
    assert process.exitcode == 0, process.exitcode
    return type(process).__name__, int(open(place).read())

if __name__ == "__main__":
    prepare_processes(preloaded=False)
    server = forkserver._forkserver
    _, first = parent_of("first")
    assert first == server._forkserver_pid
    lost = os.path.abspath("lost")
    if sys.argv[1] == "refused":
        with socket.socket(socket.AF_UNIX) as listener:
            listener.bind(lost)
    server._forkserver_address = lost
    name, second = parent_of("second")
    print(name, second == os.getpid(), second == first, second == server._forkserver_pid)
"""


@pytest.mark.parametrize(
    ("how", "started"),
    [
        ("refused", "ForkServerProcess False False True"),
        # Its folder may be gone, so that no other one could have a socket there.
        ("removed", "SpawnProcess True False False"),
    ],
)
def test_a_process_starts_all_the_same(how: str, started: str, tmp_path: Path) -> None:
    (tmp_path / "program.py").write_text(_PROGRAM)
    done = subprocess.run(
        [sys.executable, "program.py", how],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1] == started, done.stderr
