"""A worker process and its keeper, from the side of their slot."""

from __future__ import annotations

import contextlib
import os
import pickle
import socket
import time
from multiprocessing.process import BaseProcess

import psutil

from drivora_service.execution.fork_server import forget_process, start_process
from drivora_service.runs.run_report import RunSpec
from drivora_service.worker.channel import (
    Channel,
    ChannelClosedError,
    Frame,
    Kind,
    ProtocolError,
    Waiting,
)
from drivora_service.worker.keeper import HandedFile, is_guard, keep
from drivora_service.worker.loop import WorkerTask
from drivora_service.worker.process_readings import (
    ProcessHandle,
    descendants_of,
    list_children,
    read_last_pid,
    read_process,
)
from drivora_service.worker.progress_board import BoardReader
from drivora_service.worker.worker_messages import Ended, Leftovers, Started, message_of

_ANSWER_S = 10.0
"""Seconds within which a keeper answers, and reports the end of a worker with a closed channel."""
_END_S = 10.0
"""Seconds within which a keeper ends everything; longer than its own time limit."""
_LOOK_S = 0.05
"""Seconds between two looks whether a keeper that is waited for still works."""
_LOOK_AGAIN_S = 1.0
"""Seconds after which processes are looked for even if the system seems to have started none: a
process with enough rights can change what the system tells."""


class WorkerDiedError(Exception):
    """The worker process ended unexpectedly.

    Attributes:
        exit_code: Its exit code; the negative number of the signal that ended it, if one did.
    """

    def __init__(self, exit_code: int) -> None:
        """Creates the error for an exit code."""
        super().__init__(f"the worker process ended with {exit_code}")
        self.exit_code = exit_code


class KeeperLostError(Exception):
    """The keeper of a worker ended or does not answer; the worker's exit code is unknown."""


class KeptWorker:
    """A worker, from its start to its end.

    Attributes:
        board: Progress of the worker.
        pid: Its process id, ``None`` until the keeper has told it.
    """

    def __init__(self, task: WorkerTask, log: int) -> None:
        """Starts the keeper, which starts the worker; does not wait for either.

        Args:
            task: Task of the worker.
            log: Descriptor of the log.

        Raises:
            Exception: The system starts no process; the type depends on the missing resource.
        """
        self.pid: int | None = None
        self._worker: ProcessHandle | None = None
        self._exit_code: int | None = None
        self._leftovers: tuple[str, ...] | None = None
        self._descendants: dict[int, ProcessHandle] = {}
        self._started_processes: int | None = None
        self._looked_at = 0.0
        self.board = BoardReader()
        # One connection with the worker and another one with its keeper: code under test can write
        # to the first, so the keeper reports on the second how the worker ended.
        channel, theirs = socket.socketpair()
        control, keepers = socket.socketpair()
        self._channel, self._control = Channel(channel), Channel(control)
        self._both = Waiting(self._channel, self._control)
        self._answers = Waiting(self._control)
        try:
            self._process: BaseProcess = start_process(
                keep, (keepers, theirs, HandedFile(log), HandedFile(self.board.fileno()), task)
            )
        except BaseException:
            for end in (self._channel, self._control, self.board):
                end.close()
            raise
        finally:
            # Without descriptors of their ends here, the channels close with the processes.
            theirs.close()
            keepers.close()
        self._keeper = ProcessHandle(self._process.pid or 0)

    def begin(self, spec: RunSpec) -> None:
        """Hands a run to the ready worker; does not wait until it is received."""
        self._channel.put(Frame(Kind.RUN, pickle.dumps(spec)))

    def receive(self, timeout: float) -> Frame | None:
        """Waits for a message of the worker; ``None`` after ``timeout`` seconds.

        Raises:
            WorkerDiedError: It has ended, and all that it sent has been received.
            KeeperLostError: Its keeper has ended.
            ProtocolError: It has sent something that is no message.
        """
        # A wait without an event is not enough to return: a message that has begun may be overdue,
        # and a process that the worker has forked may keep the channel of a dead worker open.
        if (
            not self._channel.has_message
            and not self._both.wait(timeout)
            and not self._channel.is_within_message
            and self._exit_code is None
        ):
            return None
        try:
            frame = self._channel.read()
            if frame is None:
                self._receive_keeper()
                # Messages that it sent before it died count. The second look, after the exit code,
                # finds all of them; one that is made before could miss the last.
                frame = None if self._exit_code is None else self._channel.read()
        except ChannelClosedError:
            self._expect_end()
            frame = None
        if frame is None and self._exit_code is not None:
            raise WorkerDiedError(self._exit_code)
        return frame

    def wait_until_known(self, timeout: float) -> bool:
        """Waits until the keeper has reported the worker's process id, ``timeout`` s at most.

        A worker may be ready before: keeper and worker run at the same time from the fork on.

        Raises:
            KeeperLostError: The keeper has ended.
        """
        self._receive_keeper()
        if self.pid is None and self._answers.wait(timeout):
            self._receive_keeper()
        return self.pid is not None

    def _expect_end(self) -> None:
        """Waits for the exit code of a worker with a closed channel.

        Raises:
            ProtocolError: The worker lives: code under test has closed the channel.
            KeeperLostError: The keeper does not report the end.
        """
        # The kernel closes the files of a process before its parent can learn of its end.
        until = time.monotonic() + _ANSWER_S
        while self._exit_code is None:
            if time.monotonic() > until:
                lives = self.pid is not None and read_process(self.pid) is not None
                if lives and not self._keeper.is_stopped:
                    raise ProtocolError("it closed its channel")
                raise KeeperLostError(f"the keeper did not answer within {_ANSWER_S:g} s")
            self._answers.wait(_LOOK_S)
            self._receive_keeper()

    def _receive_keeper(self) -> None:
        try:
            while (frame := self._control.read()) is not None:
                match message_of(frame):
                    case Started(pid=pid):
                        self._worker = ProcessHandle(pid)
                        self.pid = pid
                    case Ended(exit_code=exit_code):
                        self._exit_code = exit_code
                    case Leftovers(names=names):
                        self._leftovers = names
        except (ChannelClosedError, ProtocolError) as error:
            if self._exit_code is None:
                # The worker is killed with its keeper.
                raise KeeperLostError(f"the keeper of the worker was lost: {error}") from None

    @property
    def is_idle(self) -> bool:
        """Whether the worker is alive and has sent nothing unrequested."""
        try:
            return self.receive(0.0) is None and not self._channel.is_within_message
        except (WorkerDiedError, KeeperLostError, ProtocolError):
            return False

    def leftovers(self) -> tuple[str, ...]:
        """Returns the names of the live processes beside the worker and its ADSs.

        Raises:
            KeeperLostError: The keeper has ended or does not answer.
        """
        # Three looks, the cheapest first: a counter of the system, the lists of children, and a
        # question to the keeper, which wakes another process (decision 38).
        count, now = read_last_pid(), time.monotonic()
        is_recent = now - self._looked_at < _LOOK_AGAIN_S
        if count is not None and count == self._started_processes and is_recent:
            return ()
        if self._is_alone() and not self._keeper.is_stopped:
            # Counted before the look, so that no process that began during it is missed.
            self._started_processes, self._looked_at = count, now
            return ()
        self._leftovers = None
        self._control.put(Frame(Kind.LOOK))
        until = time.monotonic() + _ANSWER_S
        while self._leftovers is None and self._exit_code is None:
            if time.monotonic() > until or self._keeper.is_stopped:
                raise KeeperLostError("the keeper does not answer")
            self._answers.wait(_LOOK_S)
            self._receive_keeper()
        return self._leftovers or ()

    def descendants(self) -> list[int]:
        """Returns the ids of live processes started in the worker, ADSs left out."""
        if self._is_alone():
            found = []
        else:
            descendants = descendants_of(self._keeper.pid, spare=is_guard)
            found = [pid for pid in descendants if pid != self.pid]
        # After the look: if the keeper has ended by now, its id may have been another process's.
        # The handles of before are kept, for end().
        if not self._keeper.lives:
            return []
        for pid in [pid for pid in self._descendants if pid not in found]:
            self._descendants.pop(pid).close()
        for pid in found:
            # Kept in case the keeper, which would end them, is lost.
            if pid not in self._descendants:
                self._descendants[pid] = ProcessHandle(pid)
        return found

    def _is_alone(self) -> bool:
        """Returns whether the worker has started no process; false if that is not certain.

        Orphans go to the keeper, which is read after the worker, so that none is missed.
        """
        if self.pid is None or list_children(self.pid) != []:
            return False
        return list_children(self._keeper.pid) == [self.pid]

    def end(self) -> None:
        """Ends the worker and all that was started in it, and waits until they are gone."""
        self._control.put(Frame(Kind.END))
        # A keeper that has not started its worker yet need not do so to end it: a worker that it
        # forks at this moment finds that its parent has died, and ends (die_with_keeper).
        if not (self._has_begun() and self._ends()):
            # Looked for before the keeper is killed: afterwards they are another process's orphans.
            # The worker dies with its keeper; it is killed here where the system does not do it.
            self.descendants()
            self._keeper.kill()
            remains = [*self._descendants.values(), *map(ProcessHandle, self._session())]
            if self._worker is not None:
                remains.append(self._worker)
            for handle in remains:
                handle.kill()
                handle.close()
        self._close()
        forget_process(self._process)

    def _has_begun(self) -> bool:
        with contextlib.suppress(KeeperLostError):
            self._receive_keeper()
        return self.pid is not None

    def _ends(self) -> bool:
        """Waits for the end of the keeper; false if it did not end everything."""
        until = time.monotonic() + _END_S
        try:
            while time.monotonic() < until and not self._keeper.is_stopped:
                self._answers.wait(_LOOK_S)
                self._receive_keeper()
                if self._exit_code is not None and not self._keeper.lives:
                    return True
        except KeeperLostError:
            pass
        return False

    def _session(self) -> list[int]:
        """Returns the processes left of the worker's session, whose id is not reused before."""
        found = []
        if self.pid is not None:
            for pid in psutil.pids():
                with contextlib.suppress(OSError):
                    if os.getsid(pid) == self.pid and pid != self.pid:
                        found.append(pid)
        return found

    def _close(self) -> None:
        self._channel.close()
        self._control.close()
        self.board.close()
        self._keeper.close()
        for handle in self._descendants.values():
            handle.close()
        self._descendants.clear()
        if self._worker is not None:
            self._worker.close()
