"""The process between the fork server and a worker: it starts the worker and cleans up after it.

The keeper runs no code under test. It is the parent of the worker and adopts the orphans of the
worker's processes (Linux), so it reports how the worker ended, reaps every process, and kills all
that are left, also those in sessions of their own. It ends when its worker has ended, when its
slot says so, and when its slot is gone.
"""

from __future__ import annotations

import contextlib
import ctypes
import os
import select
import signal
import socket
import sys
import time
import traceback
from multiprocessing.reduction import DupFd
from typing import Any, NoReturn

import psutil

from drivora_service.agents.remote import guard
from drivora_service.worker.channel import (
    ChannelClosedError,
    Kind,
    ProtocolError,
    receive,
    send,
)
from drivora_service.worker.loop import WorkerTask, serve
from drivora_service.worker.parent_death import die_with_keeper
from drivora_service.worker.process_readings import children_of, read_process
from drivora_service.worker.worker_messages import Ended, Leftovers, Started, frame_of

_PR_SET_CHILD_SUBREAPER = 36
_GRACE_S = 3.0
"""Seconds in which the notified guards of ADSs end them and remove their files."""
_KILL_S = 3.0
"""Seconds after which the keeper stops waiting for the end of a killed process."""
_PAUSE_S = 0.002
"""Seconds between two looks for processes that are still there."""
_MOST_NAMES = 20
"""Names of processes in an answer to the slot, which writes them into a line of the log."""


class HandedFile:
    """A descriptor that is handed to another process at its start."""

    def __init__(self, file: int) -> None:
        """Takes the descriptor; its owner closes it."""
        self._file = file

    def detach(self) -> int:
        """Returns the descriptor; in the receiving process, its own copy."""
        return self._file

    def __reduce__(self) -> tuple[Any, ...]:
        # Made while the process is being started: at any other time it would be offered by a thread
        # of this process, to whichever process asks for it.
        return _rebuild_file, (DupFd(self._file),)


def _rebuild_file(handed: Any) -> HandedFile:
    return HandedFile(handed.detach())


def keep(
    control: socket.socket,
    channel: socket.socket,
    log: HandedFile,
    board: HandedFile,
    task: WorkerTask,
) -> None:
    """Starts a worker and returns after it has ended and nothing of it is left.

    Args:
        control: The connection of the keeper with the slot.
        channel: The connection of the worker with the slot.
        log: Receives the output of the keeper and the worker.
        board: Memory in which the worker shows its progress.
        task: Task of the worker.
    """
    _print_to(log.detach())
    # The server handles an interrupt typed at a terminal.
    os.setsid()
    # Before the worker exists: an orphan of it would go to PID 1, where the keeper cannot find it.
    _adopt_orphans()
    # The self-pipe of D. J. Bernstein: the end of a child writes a byte, so that one poll waits for
    # both children and commands. Set up before the fork, so that no end is missed. A signal that is
    # ignored by default would write nothing, hence the handler that does nothing.
    woken, waker = os.pipe()
    os.set_blocking(woken, False)
    os.set_blocking(waker, False)
    signal.signal(signal.SIGCHLD, lambda *_: None)
    signal.set_wakeup_fd(waker, warn_on_full_buffer=False)
    keeper, cells = os.getpid(), board.detach()
    lifeline, held = os.pipe()
    worker = os.fork()
    if worker == 0:
        # Code under test must not speak for the keeper, nor hold the writing end of its own
        # lifeline, which would then never close.
        for file in (woken, waker, held, control.detach()):
            os.close(file)
        _become_worker(keeper, lifeline, channel, cells, task)
    # With a copy of the channel here, the slot would not see that the worker has closed it.
    for file in (lifeline, cells, channel.detach()):
        os.close(file)
    # If the slot is gone, serve() finds its end closed and ends the worker.
    with contextlib.suppress(BrokenPipeError, ConnectionResetError):
        send(control, frame_of(Started(pid=worker)))
    exit_code = _Keeper(control, woken, worker).serve()
    # The exit code first, as the run has ended with the worker. The end of this process tells the
    # slot that all else is gone as well; it waits for that before it starts another worker.
    with contextlib.suppress(BrokenPipeError, ConnectionResetError):
        send(control, frame_of(Ended(exit_code=exit_code)))
    _end_all(worker)
    # Nothing is left to do, and exit handlers inherited from the fork server must not run.
    os._exit(0)


def _print_to(log: int) -> None:
    os.dup2(log, 1)
    os.dup2(log, 2)
    os.close(log)


def _become_worker(
    keeper: int, lifeline: int, channel: socket.socket, board: int, task: WorkerTask
) -> NoReturn:
    """Becomes the worker; never returns into the code of the keeper."""
    code = 1
    try:
        # The pipe of the keeper was closed above; its number may come to mean another file.
        signal.set_wakeup_fd(-1)
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        # Before any code under test, and with a check that the keeper has not died in between.
        die_with_keeper(keeper, lifeline)
        # A session of its own: the keeper must not get signals that an agent sends to its group.
        os.setsid()
        serve(channel, board, task)
        code = 0
    except BaseException:
        traceback.print_exc()
    finally:
        # Not sys.exit(): exit handlers inherited from the fork server must not run here.
        with contextlib.suppress(Exception):
            sys.stdout.flush()
            sys.stderr.flush()
        os._exit(code)


class _Keeper:
    """Waits for the end of the worker and executes the slot's commands meanwhile."""

    def __init__(self, control: socket.socket, woken: int, worker: int) -> None:
        self._control, self._woken, self._worker = control, woken, worker
        self._slot_is_there = True
        self._exit_code: int | None = None

    def serve(self) -> int:
        """Returns the exit code of the worker."""
        poll = select.poll()
        poll.register(self._woken, select.POLLIN)
        poll.register(self._control, select.POLLIN)
        while True:
            # Before the wait: a worker that ended before the poll was set up is found as well. One
            # that ends between this line and the poll has written a byte, and the poll returns.
            self._reap()
            if self._exit_code is not None:
                return self._exit_code
            for file, _ in poll.poll():
                if file == self._woken:
                    # All bytes at once, as one round reaps all children that have ended.
                    with contextlib.suppress(BlockingIOError):
                        os.read(self._woken, 65536)
                elif not self._execute_command():
                    # A closed connection would wake every poll until the worker has ended.
                    poll.unregister(self._control)
                    # Not reaped yet, so the id is the worker's own.
                    os.kill(self._worker, signal.SIGKILL)

    def _reap(self) -> None:
        # Signals of the same number merge, so one may stand for several children; adopted orphans
        # are reaped on the way.
        with contextlib.suppress(ChildProcessError):
            while True:
                pid, status = os.waitpid(-1, os.WNOHANG)
                if pid == 0:
                    return
                if pid == self._worker:
                    self._exit_code = os.waitstatus_to_exitcode(status)

    def _execute_command(self) -> bool:
        """Executes a command of the slot; false if the worker must end."""
        try:
            frame = receive(self._control)
            if frame.kind is not Kind.LOOK:
                return False
            send(self._control, frame_of(Leftovers(names=tuple(self._leftovers()))))
        except (ChannelClosedError, ProtocolError, OSError):
            return False
        return True

    def _leftovers(self) -> list[str]:
        """Returns the names of live processes, without the worker and the ADSs kept for later."""
        found: list[str] = []
        # The worker's children first: one whose parent ends in between is then seen here, as ours.
        # Their descendants are not listed: one is enough for the worker to be replaced.
        coming = [*children_of(self._worker), *children_of(os.getpid())]
        while coming and len(found) < _MOST_NAMES:
            pid = coming.pop()
            reading = read_process(pid)
            if pid == self._worker or reading is None or reading.state == "Z" or is_guard(pid):
                continue
            found.append(f"{reading.name} ({pid})")
        return found


def _adopt_orphans() -> None:
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)


def is_guard(pid: int) -> bool:
    """Returns whether a process is the guard of an ADS, which ends with its worker."""
    try:
        return guard.__file__ in psutil.Process(pid).cmdline()[:5]
    except psutil.Error:
        return False


def _end_all(worker: int) -> None:
    """Kills and reaps the worker's processes; guards may end their ADSs themselves first."""
    if sys.platform != "linux":
        # Processes that have left the worker's process group are not known here.
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(worker, signal.SIGKILL)
        return
    begun = time.monotonic()
    own = os.getpid()
    # Repeated, as the children of a process that was killed become ours, and a process may fork
    # while it is killed. The limit is for one that waits in the kernel, which cannot be killed.
    while (passed := time.monotonic() - begun) <= _GRACE_S + _KILL_S:
        for pid in children_of(own):
            # Children that have not been reaped: the ids are their own.
            if passed > _GRACE_S or not is_guard(pid):
                with contextlib.suppress(ProcessLookupError, PermissionError):
                    os.kill(pid, signal.SIGKILL)
        try:
            while os.waitpid(-1, os.WNOHANG)[0]:
                pass
        except ChildProcessError:
            # Only this says that there are none: the list above may lack children while one of them
            # ends (proc(5)), and a process that was not listed would outlive the keeper.
            return
        time.sleep(_PAUSE_S)
