"""Runs SUMO's netconvert, which the extra ``networks`` installs."""

from __future__ import annotations

import contextlib
import importlib.metadata
import importlib.util
import os
import re
import resource
import signal
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from drivora_service.errors import NetworkError

# Time, paths and options, which differ between machines.
_HEADER = re.compile(rb"<!-- generated on .*?-->\s*", re.DOTALL)
_SHOWN_ERRORS = 5

MAX_SECONDS = 600.0
"""Maximum time of a conversion; a city takes a minute."""

MAX_MEMORY_BYTES = 8 << 30
"""Maximum address space; 100 MB of OpenStreetMap need about a third."""

MAX_OUTPUT_BYTES = 1 << 30
"""Maximum size of each written file."""

_LIMITS = (
    (resource.RLIMIT_AS, MAX_MEMORY_BYTES),
    (resource.RLIMIT_FSIZE, MAX_OUTPUT_BYTES),
)
_READ_BYTES = 1_000_000
"""Maximum number of printed errors in messages; the first ones tell the cause."""


def netconvert_version() -> str:
    """Returns the version of the installed netconvert, such as ``1.28.0``.

    Raises:
        NetworkError: It is not installed.
    """
    _sumo_home()
    try:
        return importlib.metadata.version("eclipse-sumo")
    except importlib.metadata.PackageNotFoundError:
        raise _make_missing_error() from None


def convert(arguments: Sequence[str], *, timeout: float = MAX_SECONDS) -> bytes:
    """Runs netconvert and returns the written network, without the varying header.

    Args:
        arguments: All arguments except the output file.
        timeout: Seconds after which the conversion is cancelled.

    Raises:
        NetworkError: netconvert is not installed, rejected its input, crashed, or took too long,
            too much memory or too much space.
    """
    home = _sumo_home()
    with tempfile.TemporaryDirectory(prefix="drivora-netconvert-") as directory:
        output = Path(directory) / "network.net.xml"
        run_converter(home / "bin" / "netconvert", arguments, output, timeout=timeout)
        return _HEADER.sub(b"", output.read_bytes(), count=1)


def run_converter(program: Path, arguments: Sequence[str], output: Path, *, timeout: float) -> None:
    """Runs a program with the arguments of netconvert.

    Args:
        program: The program; SUMO's home is two folders above it.
        arguments: All arguments except the output file.
        output: Path of the network; the printed text is kept beside it.
        timeout: Seconds.

    Raises:
        NetworkError: As :func:`convert`.
    """
    home = program.parents[1]
    environment = os.environ | {"SUMO_HOME": str(home), "PROJ_DATA": str(home / "data" / "proj")}
    command = [str(program), *arguments, "--output-file", str(output)]
    # Its printed text goes to a file, since a large source causes many warnings.
    log = output.with_name("printed")
    try:
        returncode = _run(command, environment, log, timeout)
    except subprocess.TimeoutExpired:
        raise NetworkError(
            f"netconvert did not finish within {timeout:g} s; cut out the part that is needed"
        ) from None
    with log.open("rb") as file:
        printed = file.read(_READ_BYTES).decode("utf-8", "replace")
    if returncode < 0:
        raise NetworkError(f"netconvert crashed ({_signal(-returncode)}): {_summary(printed)}")
    if returncode != 0 or not output.is_file():
        raise NetworkError(f"netconvert failed: {_summary(printed)}")


def _run(command: Sequence[str], environment: Mapping[str, str], log: Path, timeout: float) -> int:
    """Runs a command within the limits and returns its code, negative for a signal."""
    with (
        log.open("wb") as printed,
        subprocess.Popen(
            command,
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=printed,
            stderr=subprocess.STDOUT,
        ) as process,
    ):
        try:
            _limit(process.pid)
            return process.wait(timeout)
        finally:
            process.kill()


def _limit(pid: int) -> None:
    """Limits a process after its start, since doing so before is unsafe with threads."""
    # Only supported by Linux.
    if hasattr(resource, "prlimit"):
        # A process that has ended needs no limits.
        with contextlib.suppress(ProcessLookupError):
            for limit, most in _LIMITS:
                _, hard = resource.prlimit(pid, limit)
                # One that this process has itself cannot be raised.
                own = most if hard == resource.RLIM_INFINITY else min(most, hard)
                resource.prlimit(pid, limit, (own, own))


def _signal(number: int) -> str:
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"


def _sumo_home() -> Path:
    spec = importlib.util.find_spec("sumo")
    for location in (spec.submodule_search_locations or []) if spec else []:
        if (Path(location) / "bin" / "netconvert").exists():
            return Path(location)
    raise _make_missing_error()


def _make_missing_error() -> NetworkError:
    return NetworkError(
        "netconvert is not installed; it comes with an extra: pip install '.[networks]' in the "
        "checkout"
    )


def _summary(printed: str) -> str:
    lines = [line.strip() for line in printed.splitlines()]
    errors = [
        line.removeprefix("Error: ").rstrip(".") for line in lines if line.startswith("Error: ")
    ]
    errors = errors or [line for line in lines if line and not line.startswith("Warning: ")][-1:]
    hidden = len(errors) - _SHOWN_ERRORS
    more = [f"and {hidden} more errors"] if hidden > 0 else []
    return "; ".join(errors[:_SHOWN_ERRORS] + more) or "it gave no reason"
