"""What the suite runs on."""

from __future__ import annotations

import os
import platform
import subprocess
from importlib import metadata
from pathlib import Path

import psutil

from benchmarks.suite.result import Machine, PackageVersion

_PACKAGES = (
    "drivora",
    "libsumo",
    "numba",
    "numpy",
    "scipy",
    "pyarrow",
    "sqlalchemy",
)


def this_machine() -> Machine:
    """Returns the state of this machine now."""
    return Machine(
        cpu=_cpu(),
        cores=len(os.sched_getaffinity(0)),
        memory_gb=round(psutil.virtual_memory().total / 1e9, 1),
        system=f"{platform.system()} {platform.release()} {platform.machine()}",
        python=platform.python_version(),
        load=os.getloadavg(),
        nice=os.nice(0),
        commit=_commit(),
        packages=tuple(
            PackageVersion(package=name, version=metadata.version(name)) for name in _PACKAGES
        ),
    )


def _cpu() -> str:
    for line in Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return line.partition(":")[2].strip()
    return platform.processor()


def _commit() -> str:
    described = subprocess.run(
        ["git", "describe", "--always", "--dirty", "--abbrev=12", "--exclude=*"],
        cwd=Path(__file__).parent,
        capture_output=True,
        text=True,
        check=False,
    )
    return described.stdout.strip() if described.returncode == 0 else ""
