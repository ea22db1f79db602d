"""How many tests run at a time, and whether the checks run beside them, for the Makefile.

python tests/load.py processes
python tests/load.py jobs
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from pathlib import Path

GB = 1e9
_A_PROCESS = 1.7 * GB
"""Of a process with tests, with its fork server, and the services and workers that they start.

Two of them take 3.6 GB at the end of the fast tests, of which the processes themselves 2 GB.
"""
_BESIDE = 1.0 * GB
"""Of all others of the machine."""
_WITH_CHECKS = 6.0 * GB
"""Memory with which the types are checked beside two processes with tests: 1.2 GB and 3.6 GB."""
_LIMITS = (
    Path("/sys/fs/cgroup/memory.max"),
    Path("/sys/fs/cgroup/memory/memory.limit_in_bytes"),
)


def memory(limits: Sequence[Path] = _LIMITS) -> float:
    """Returns the bytes of memory of this machine, or of the container in which this runs."""
    found = [float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))]
    for file in limits:
        text = file.read_text().strip() if file.is_file() else ""
        if text.isdigit():
            found.append(float(text))
    return min(found)


def processes(size: float, cores: int) -> int:
    """Returns the processes with tests; they wait for others now and then: one more than cores."""
    return max(1, min(cores + 1, int((size - _BESIDE) // _A_PROCESS)))


def jobs(size: float) -> int:
    """Returns how many of the checks and the tests run at a time."""
    return 2 if size >= _WITH_CHECKS else 1


if __name__ == "__main__":
    wanted = {"processes": processes(memory(), os.cpu_count() or 1), "jobs": jobs(memory())}
    print(wanted[sys.argv[1]])
