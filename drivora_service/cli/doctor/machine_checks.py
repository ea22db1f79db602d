"""Checks of what runs need of a machine: kernels, speed, temporary files, the environment."""

from __future__ import annotations

import difflib
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from drivora_service.cli.doctor.findings import Check, Finding, noted, ok, problem
from drivora_service.cli.doctor.software_checks import CHILD_S
from drivora_service.compilation.compilation_progress import VARIABLE
from drivora_service.compilation.machine_code_files import (
    count_machine_code,
    has_machine_code,
    machine_code_folders,
)

SLOW = 20.0
"""Simulated seconds a second of a whole run below which a machine is called slow."""

USUAL = "100 to 500"
"""The same on a machine of 2020 that does nothing else."""

_LONGEST_TEMPORARY = 75
"""Characters of the folder of temporary files that leave room for the socket of the fork server."""

_OTHER_NAMES = frozenset(
    {
        "SERVER",
        "TOKEN",
        "AGENT_ADDRESS",
        "DILU_ENDPOINT",
        "DILU_MODEL",
        "DILU_API_KEY",
        "DILU_TIMEOUT_S",
        VARIABLE.removeprefix("DRIVORA_"),
    }
)
"""Variables that are no settings of a service, without their prefix."""

_PREFIX = "DRIVORA_"
_SHOWN = frozenset({"DATA_DIR", "AGENTS_DIR", "LAWS_DIR", "WORKERS", "HOST", "PORT", "EXECUTOR"})
"""Settings whose values hold no secret and help in a report."""


def check_kernels() -> Iterator[Finding]:
    """Looks for compiled kernels, and whether new ones can be kept."""
    folders = machine_code_folders()
    counts = {folder: count_machine_code(folder) for folder in folders}
    kept = [f"{count} in {folder}" for folder, count in counts.items() if count]
    if has_machine_code():
        yield ok("kernels", f"compiled: {', '.join(kept)}")
    else:
        yield noted(
            "kernels",
            "not compiled yet: the first run compiles them, which takes about half a minute",
            "`drivora run` with any scenario compiles them and says how far it is",
        )
    if not any(map(_is_writable, folders)):
        yield problem(
            "kernels",
            f"new ones cannot be kept: {', '.join(map(str, folders))} cannot be written, so that "
            "every start compiles them again",
            "Set NUMBA_CACHE_DIR to a folder that can be written and stays",
        )


def _is_writable(folder: Path) -> bool:
    """Returns whether files can be made in a folder, which may have to be made itself."""
    while not folder.exists() and folder != folder.parent:
        folder = folder.parent
    return folder.is_dir() and os.access(folder, os.W_OK | os.X_OK)


def check_speed() -> Iterator[Finding]:
    """Simulates and judges a scenario in a process of its own, and compares its speed."""
    if not has_machine_code():
        yield noted(
            "speed", "not measured, as kernels are not compiled yet", "`drivora doctor` after a run"
        )
        return
    done = subprocess.run(
        [sys.executable, "-m", "drivora_service.cli.doctor.speed_probe"],
        capture_output=True,
        text=True,
        timeout=4 * CHILD_S,
        check=False,
    )
    if done.returncode:
        reason = (done.stderr.strip() or f"its process ended with {done.returncode}").splitlines()
        yield problem(
            "speed",
            f"no scenario could be simulated: {reason[-1]}",
            "Mend the other problems first",
        )
        return
    measured = json.loads(done.stdout.splitlines()[-1])
    factor, step = measured["factor"], measured["step_us"]
    text = (
        f"{factor:.0f} times real time for a whole run of {measured['sim_time_s']:.0f} s, "
        f"{step:.0f} µs a step; usual: {USUAL}"
    )
    if factor < SLOW:
        yield noted(
            "speed",
            f"slow: {text}; {os.cpu_count()} processors, load {os.getloadavg()[0]:.1f}",
            "End what else uses the processors, or give the machine or container more of them",
        )
    else:
        yield ok("speed", text)


def check_temporary_files() -> Iterator[Finding]:
    """Checks the folder of temporary files, in which workers have their sockets."""
    folder = tempfile.gettempdir()
    if len(folder) > _LONGEST_TEMPORARY:
        yield problem(
            "temporary files",
            f"{folder} has {len(folder)} characters, and workers have sockets in it",
            f"Set TMPDIR to a folder with a path of at most {_LONGEST_TEMPORARY} characters",
        )
        return
    with tempfile.TemporaryFile():
        pass
    yield ok("temporary files", folder)


def check_environment() -> Iterator[Finding]:
    """Checks the environment variables that change what Drivora does."""
    from drivora_service.settings import Settings

    known = {name.upper() for name in Settings.model_fields} | _OTHER_NAMES
    given = sorted(name for name in os.environ if name.startswith(_PREFIX))
    for name in given:
        word = name.removeprefix(_PREFIX)
        if word not in known:
            close = difflib.get_close_matches(word, known, n=1)
            meant = f"Did you mean {_PREFIX}{close[0]}?" if close else "Unset it"
            yield problem("environment", f"{name} is no variable of Drivora", meant)
    if os.environ.get("PYTHONDONTWRITEBYTECODE"):
        yield noted(
            "environment",
            "PYTHONDONTWRITEBYTECODE is set: every process takes seconds to compile all modules",
            "Unset it",
        )
    for name, value in sorted(os.environ.items()):
        if name.startswith("NUMBA_") and name != "NUMBA_CACHE_DIR":
            yield noted(
                "environment", f"{name}={value} changes how kernels are compiled", "Unset it"
            )
    shown = [
        f"{name}={os.environ[name]}" if name.removeprefix(_PREFIX) in _SHOWN else f"{name} (set)"
        for name in given
    ]
    others = ("NUMBA_CACHE_DIR", "PYTHONPATH", "SUMO_HOME", "VIRTUAL_ENV", "TMPDIR")
    shown += [f"{name}={os.environ[name]}" for name in others if os.environ.get(name)]
    yield ok("environment", ", ".join(shown) or "no variable of Drivora is set")


CHECKS = (
    Check("kernels", check_kernels),
    Check("speed", check_speed),
    Check("temporary files", check_temporary_files),
    Check("environment", check_environment),
)
