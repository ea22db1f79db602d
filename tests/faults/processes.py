"""The processes of a service in /proc, independent of the service's own answers."""

from __future__ import annotations

import contextlib
import os
import signal
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import psutil


def tree(pid: int) -> tuple[psutil.Process, ...]:
    """Returns a process and its descendants; none if it is gone."""
    with contextlib.suppress(psutil.NoSuchProcess):
        process = psutil.Process(pid)
        return (process, *process.children(recursive=True))
    return ()


def server(pid: int) -> int:
    """Returns the id of the server that a process is, or has started.

    Raises:
        AssertionError: There is none.
    """
    for process in tree(pid):
        with contextlib.suppress(psutil.Error):
            if process.cmdline()[1:4] == ["-m", "drivora_service.cli", "serve"]:
                return process.pid
    raise AssertionError(f"process {pid} has started no server")


def fork_server(server: int) -> psutil.Process | None:
    """Returns the process from which the workers of a server come."""
    return next((p for p in tree(server)[1:] if _says(p, "forkserver")), None)


def workers(folder: Path) -> tuple[psutil.Process, ...]:
    """Returns the workers with logs in a folder; they are the children of keepers."""
    found = _in_slots(folder)
    return tuple(process for process, parent in found.values() if parent in found)


def keepers(folder: Path) -> tuple[psutil.Process, ...]:
    """Returns the processes between the fork server and the workers."""
    found = _in_slots(folder)
    return tuple(process for process, parent in found.values() if parent not in found)


def _in_slots(folder: Path) -> dict[int, tuple[psutil.Process, int]]:
    """Returns the leaders of sessions of the fork server's code that log into a folder.

    Includes processes that were spawned because the fork server had been killed.
    By the id of each, with that of its parent. What an agent starts runs another program, or
    belongs to the session of a worker. Of a fork server that was killed they are no descendants.
    """
    found = {}
    for process in psutil.process_iter():
        with contextlib.suppress(psutil.Error, OSError):
            log = Path(f"/proc/{process.pid}/fd/1").readlink()
            if log.parent != folder or os.getsid(process.pid) != process.pid:
                continue
            if _says(process, "forkserver") or _says(process, "spawn_main"):
                found[process.pid] = (process, process.ppid())
    return found


def _says(process: psutil.Process, word: str) -> bool:
    with contextlib.suppress(psutil.Error):
        return any(word in part for part in process.cmdline())
    return False


def with_argument(marker: str) -> list[psutil.Process]:
    """Returns every living process of the machine that has an argument."""
    found = []
    for process in psutil.process_iter():
        with contextlib.suppress(psutil.Error):
            if marker in process.cmdline() and process.status() != psutil.STATUS_ZOMBIE:
                found.append(process)
    return found


def with_variable(name: str, value: str) -> list[psutil.Process]:
    """Returns every living process of the machine that was started with an environment variable."""
    found = []
    for process in psutil.process_iter():
        with contextlib.suppress(psutil.Error):
            if process.environ().get(name) == value and process.status() != psutil.STATUS_ZOMBIE:
                found.append(process)
    return found


def send(process: psutil.Process, number: signal.Signals) -> None:
    """Sends a signal to a process that may be gone."""
    with contextlib.suppress(psutil.NoSuchProcess):
        process.send_signal(number)


@contextlib.contextmanager
def stopped(process: psutil.Process, *, seconds: float) -> Iterator[None]:
    """Stops a process for some time at least, and lets it go on afterwards."""
    begun = time.monotonic()
    send(process, signal.SIGSTOP)
    try:
        yield
        time.sleep(max(0.0, begun + seconds - time.monotonic()))
    finally:
        send(process, signal.SIGCONT)


def wait_until(condition: Callable[[], object], *, seconds: float, what: str) -> None:
    """Waits for a condition.

    Raises:
        AssertionError: It is not met in time; names ``what`` was waited for.
    """
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline, f"after {seconds:g} s: {what}"
        time.sleep(0.02)
