"""Commands of the tests in processes of their own."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

# In a process of its own, as it ends its fork server.
_PROGRAM = """
import os, signal, sys
from multiprocessing import forkserver
from pathlib import Path
from tests.forked_service import begin_service, wait_until_ready

if __name__ == "__main__":
    data = Path(sys.argv[1])
    begun = begin_service(data, workers=1)
    wait_until_ready(begun, data)
    server = forkserver._forkserver._forkserver_pid
    os.kill(server, signal.SIGKILL)
    os.waitpid(server, 0)
    begun.process.join(30)
    print("of multiprocessing", begun.process.exitcode, "and here", begun.poll())
    begun.send_signal(signal.SIGINT)
    begun.wait(60)
    print("announced", (data / "service.json").exists())
"""


def test_a_service_that_outlives_the_fork_server_can_be_ended(
    tmp_path: Path, repository: Path
) -> None:
    done = subprocess.run(
        [sys.executable, "-c", _PROGRAM, str(tmp_path / "data")],
        cwd=repository,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.stdout.splitlines() == [
        "of multiprocessing 255 and here None",
        "announced False",
    ], done.stderr
