"""Importing a file that is not trusted, by a process with limits of its own."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import structlog

from drivora_service.errors import NetworkError, StoreUnavailable
from drivora_service.networks.importing.import_order import (
    ENDING_S,
    PRINTED,
    RESULT,
    ImportLimits,
    ImportOrder,
    ImportResult,
    too_much_memory,
)
from drivora_service.shapes import adapter, to_json

_MODULE = "drivora_service.networks.importing.import_process"
_POLL_S = 0.02
_PAGE = os.sysconf("SC_PAGE_SIZE")
_MOST_RESULT_BYTES = 1 << 20
_MOST_SAID = 2000
"""Characters of a refusal; netconvert repeats names from the file."""
_MOST_PRINTED_BYTES = 1 << 14
_FRUGAL = {"OPENBLAS_NUM_THREADS": "1", "MALLOC_ARENA_MAX": "1"}
"""Environment variables without which threads reserve address space, of which little is used."""
_CUT = "cut out the part that is needed"

_log = structlog.stdlib.get_logger(__name__)


def import_confined(order: ImportOrder, stage: Path, cancelled: threading.Event) -> None:
    """Imports the uploaded file in a folder, whose network is then in the same folder.

    This process reads neither the file nor the network.

    Args:
        order: The order.
        stage: The folder, with the file.
        cancelled: Ends the import when it is set.

    Raises:
        NetworkError: The file cannot be used, or its import has gone beyond a limit or crashed.
        StoreUnavailable: The network cannot be written at the moment.
    """
    with (stage / PRINTED).open("wb") as printed:
        process = subprocess.Popen(
            [sys.executable, "-P", "-m", _MODULE, to_json(ImportOrder, order).decode()],
            # It ends when this pipe is closed, also by the death of this process.
            stdin=subprocess.PIPE,
            stdout=printed,
            stderr=printed,
            cwd=stage,
            env=_environment(stage),
            # A group of its own, so that netconvert ends with it.
            start_new_session=True,
        )
    try:
        code = _wait(process, order.limits, cancelled)
    finally:
        _end(process)
    result = _read_result(stage)
    if result is None:
        raise _make_death_error(code, order, stage)
    if result.storage_fault:
        raise StoreUnavailable(f"the network cannot be stored now: {result.storage_fault}")
    if result.refusal:
        raise NetworkError(_short(result.refusal))


def _wait(
    process: subprocess.Popen[bytes], limits: ImportLimits, cancelled: threading.Event
) -> int:
    """Returns the exit code of a process.

    Raises:
        NetworkError: It has not ended in time, needs too much memory, or is cancelled.
    """
    deadline = time.monotonic() + limits.wall_s
    while (code := process.poll()) is None:
        if cancelled.wait(_POLL_S):
            raise NetworkError("the import was cancelled")
        if time.monotonic() > deadline:
            raise NetworkError(
                f"the import did not finish within {limits.wall_s:g} s; {_CUT}, or import it with "
                "`drivora networks import` on the machine of the service"
            )
        if _address_space(process.pid) > limits.memory_bytes:
            raise NetworkError(too_much_memory(limits))
    return code


def _address_space(pid: int) -> int:
    """Returns the address space of a process, bytes; 0 where the system does not tell it."""
    with contextlib.suppress(OSError, ValueError, IndexError):
        return int(Path(f"/proc/{pid}/statm").read_text().split()[0]) * _PAGE
    return 0


def _end(process: subprocess.Popen[bytes]) -> None:
    """Ends a process and what it has started."""
    process.terminate()
    with contextlib.suppress(subprocess.TimeoutExpired):
        # Time to end netconvert itself, which is its child.
        process.wait(ENDING_S)
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    if process.stdin is not None:
        process.stdin.close()


def _environment(stage: Path) -> dict[str, str]:
    """Returns the environment of the process: without the settings and secrets of the service."""
    # PG…: what the driver of PostgreSQL reads, such as PGPASSWORD.
    secret = ("DRIVORA_", "PG")
    kept = {name: value for name, value in os.environ.items() if not name.startswith(secret)}
    return kept | _FRUGAL | {"TMPDIR": str(stage)}


def _read_result(stage: Path) -> ImportResult | None:
    """Returns the result, ``None`` if the process wrote none."""
    with contextlib.suppress(OSError, ValueError), (stage / RESULT).open("rb") as file:
        result: ImportResult = adapter(ImportResult).validate_json(file.read(_MOST_RESULT_BYTES))
        return result
    return None


def _make_death_error(code: int, order: ImportOrder, stage: Path) -> NetworkError:
    """Returns the error for a process that ended without a result."""
    printed = ""
    with contextlib.suppress(OSError), (stage / PRINTED).open("rb") as file:
        printed = file.read(_MOST_PRINTED_BYTES).decode(errors="replace")
    _log.warning("network_import_died", code=code, printed=printed)
    if code > 0 and "MemoryError" in printed:
        return NetworkError(too_much_memory(order.limits))
    if code == -signal.SIGXCPU:
        return NetworkError(
            f"the import needs more than {order.limits.cpu_s} s of processor time; {_CUT}"
        )
    if code == -signal.SIGKILL:
        return NetworkError(
            f"the import was killed, as happens where memory is short; import it again, or {_CUT}"
        )
    if code < 0:
        with contextlib.suppress(ValueError):
            return NetworkError(
                f"the import crashed ({signal.Signals(-code).name}); the file may be damaged"
            )
    return NetworkError(
        f"the import ended with code {code} without a result; the service's log says more"
    )


def _short(text: str) -> str:
    return text if len(text) <= _MOST_SAID else f"{text[:_MOST_SAID]}…"
