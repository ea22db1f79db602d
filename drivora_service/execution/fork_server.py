"""Starting processes from a fork server that has their imports done."""

from __future__ import annotations

import errno
import multiprocessing
import os
import signal
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from multiprocessing import forkserver
from multiprocessing.connection import wait
from multiprocessing.process import BaseProcess
from typing import Any

import structlog

from drivora_service.errors import ConfigurationError
from drivora_service.worker.process_readings import ProcessHandle

_PRELOADED = "drivora_service.worker.preloaded"

ENVIRONMENT = {
    # Results must not depend on the order of sets, nor on the features of this processor.
    "PYTHONHASHSEED": "0",
    "NUMBA_CPU_NAME": "generic",
    # A worker has one core; more threads would only take those of its neighbours.
    "NUMBA_NUM_THREADS": "1",
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
}
"""Environment variables with which every process must be started."""

_SHORT = (errno.EAGAIN, errno.EMFILE, errno.ENFILE, errno.ENOMEM)
"""Of a limit of processes, open files or memory."""

_LONGEST_FOLDER = 75
"""Characters of a path in which a socket of multiprocessing (32 more) fits the 107 of Linux."""

_EXIT_S = 5.0
"""Seconds within which a process that was killed is gone."""

_END_REPORT_S = 0.2
"""Seconds within which a fork server reports the end of a process."""

_log = structlog.get_logger(__name__)

# With each start, multiprocessing polls all processes. Of two threads that poll one that has just
# ended, the slower would get an unknown exit code.
_looking = threading.Lock()


def prepare_processes(*, preloaded: bool = True) -> None:
    """Starts the fork server, if it is not running, without waiting for it.

    Args:
        preloaded: Whether it imports what workers need, which takes a second or two.

    Raises:
        ConfigurationError: Its socket cannot be made in the folder of temporary files.
        OSError: The system gives no process, no file or no memory.
    """
    os.environ.update(ENVIRONMENT)
    forkserver.set_forkserver_preload(["__main__", *([_PRELOADED] if preloaded else [])])
    try:
        with _ignored_interrupts():
            forkserver.ensure_running()
    except OSError as error:
        if error.errno in _SHORT:
            # Of no fault of the folder; the command says what helps.
            raise
        raise ConfigurationError(
            f"no worker process can be started from the folder of temporary files, "
            f"{tempfile.gettempdir()}: {error}. Set TMPDIR to a folder that can be written, with "
            f"a path of at most {_LONGEST_FOLDER} characters"
        ) from error


@contextmanager
def _ignored_interrupts() -> Iterator[None]:
    """Has a process that is started now ignore Ctrl-C, which it gets together with this one.

    Until a fork server has got ready to ignore it, it would print a traceback.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def start_process(target: Callable[..., None], args: tuple[Any, ...]) -> BaseProcess:
    """Returns a process that was started from the fork server, or spawned if there can be none.

    Args:
        target: Function that the process calls.
        args: Its arguments; must be picklable.

    Raises:
        OSError: The system gives no process.
        EOFError: The fork server ended during the call; the next call starts another.
    """
    for _ in range(2):
        process: BaseProcess = multiprocessing.get_context("forkserver").Process(
            target=_run, args=(dict(os.environ), target, args), daemon=True
        )
        with _looking:
            _end_stopped_server()
            try:
                process.start()
                return process
            except ConnectionRefusedError as error:
                # It was killed a moment ago: its socket is closed before its end can be known.
                _log.warning("fork_server_lost", error=repr(error))
                _end_server()
            except FileNotFoundError as error:
                # Its socket is a temporary file, which some systems remove after days.
                _log.warning("fork_server_not_reached", error=repr(error))
                break
    return spawn_process(target, args)


def _end_stopped_server() -> None:
    """Ends a fork server that a signal has stopped; a start would wait for it for ever."""
    server = _server()
    if server is None:
        return
    is_stopped = server.is_stopped
    server.close()
    if is_stopped:
        _log.warning("fork_server_stopped", pid=server.pid)
        _end_server()


def _end_server() -> None:
    """Ends the fork server, if there is one, and waits until it is gone; a start begins another."""
    server = _server()
    if server is None:
        return
    server.kill()
    until = time.monotonic() + _EXIT_S
    while server.lives and time.monotonic() < until:
        time.sleep(0.01)
    server.close()


def _server() -> ProcessHandle | None:
    pid = getattr(getattr(forkserver, "_forkserver", None), "_forkserver_pid", None)
    return None if pid is None else ProcessHandle(pid)


def spawn_process(target: Callable[..., None], args: tuple[Any, ...]) -> BaseProcess:
    """Returns a process that was started without preloaded imports; see :func:`start_process`."""
    process: BaseProcess = multiprocessing.get_context("spawn").Process(
        target=target, args=args, daemon=True
    )
    with _looking:
        process.start()
    return process


def _run(environment: dict[str, str], target: Callable[..., None], args: tuple[Any, ...]) -> None:
    # The fork server has the variables with which it was started itself.
    os.environ.clear()
    os.environ.update(environment)
    # What the process starts must be able to be interrupted: the fork server itself is not.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    target(*args)


def exit_code(process: BaseProcess) -> int | None:
    """Returns the exit code of a process; the negative number of the signal that ended it."""
    with _looking:
        return process.exitcode


def kill_process(process: BaseProcess) -> None:
    """Kills a process, if it has not ended, and waits until it is gone."""
    process.kill()
    wait([process.sentinel])
    with _looking:
        process.join()
        process.close()


def forget_process(process: BaseProcess) -> None:
    """Releases a process that has ended; does nothing while its end is not known."""
    # A stopped fork server does not report the end of its children.
    if wait([process.sentinel], _END_REPORT_S):
        with _looking:
            process.join()
            process.close()
