"""One worker process and its keeper, as their slot sees them."""

from __future__ import annotations

import contextlib
import os
import pickle
import socket
import time
from multiprocessing.process import BaseProcess

import psutil

from drivora_service.execution.fork_server import forget_process, start_process
from drivora_service.runs.report import RunSpec
from drivora_service.worker.channel import (
    Channel,
    ChannelClosedError,
    Frame,
    Kind,
    ProtocolError,
    wait_for,
)
from drivora_service.worker.keeper import HandedFile, is_guard, keep
from drivora_service.worker.loop import WorkerTask
from drivora_service.worker.messages import Ended, Started, Strangers, message_of
from drivora_service.worker.processes import ProcessHandle, descendants_of, read_process
from drivora_service.worker.progress import BoardReader

_ANSWER_S = 10.0
"""Seconds within which a keeper answers, and tells the end of a worker whose channel is closed."""
_END_S = 10.0
"""Seconds within which a keeper ends everything; longer than it gives up by itself."""
_LOOK_S = 0.05


class WorkerDiedError(Exception):
    """The worker process ended unasked.

    Attributes:
        exit_code: Its exit code; the negative number of the signal that ended it, if one did.
    """

    def __init__(self, exit_code: int) -> None:
        """Takes the attribute."""
        super().__init__(f"the worker process ended with {exit_code}")
        self.exit_code = exit_code


class KeeperLostError(Exception):
    """The keeper of a worker ended or does not answer, so how the worker ended is not known."""


class KeptWorker:
    """A worker, from its start to its end.

    Attributes:
        board: What the worker shows of its progress.
        pid: Its process id, ``None`` until the keeper has told it.
    """

    def __init__(self, task: WorkerTask, log: int) -> None:
        """Starts the keeper, which starts the worker.

        Args:
            task: What the worker does.
            log: Descriptor of the log.

        Raises:
            Exception: The system gives no process; what kind depends on what is short.
        """
        self.pid: int | None = None
        self._worker: ProcessHandle | None = None
        self._exit_code: int | None = None
        self._strangers: tuple[str, ...] | None = None
        self._family: dict[int, ProcessHandle] = {}
        self.board = BoardReader()
        channel, theirs = socket.socketpair()
        control, keepers = socket.socketpair()
        self._channel, self._control = Channel(channel), Channel(control)
        try:
            self._process: BaseProcess = start_process(
                keep, (keepers, theirs, HandedFile(log), HandedFile(self.board.fileno()), task)
            )
        except BaseException:
            for end in (self._channel, self._control, self.board):
                end.close()
            raise
        finally:
            # With no end of them left here, the channels end with the processes.
            theirs.close()
            keepers.close()
        self._keeper = ProcessHandle(self._process.pid or 0)

    def begin(self, spec: RunSpec) -> None:
        """Hands a run to the worker, which is ready; does not wait until it has it."""
        self._channel.put(Frame(Kind.RUN, pickle.dumps(spec)))

    def receive(self, timeout: float) -> Frame | None:
        """Waits for a message of the worker; ``None`` after ``timeout`` seconds.

        Raises:
            WorkerDiedError: It has ended, and what it sent before has been received.
            KeeperLostError: Its keeper has ended.
            ProtocolError: It has sent something that is no message.
        """
        if not self._channel.has_message:
            wait_for((self._channel, self._control), timeout)
        try:
            frame = self._channel.read()
            if frame is None:
                self._hear_keeper()
                # What it sent before it died counts.
                frame = None if self._exit_code is None else self._channel.read()
        except ChannelClosedError:
            self._expect_end()
            frame = None
        if frame is None and self._exit_code is not None:
            raise WorkerDiedError(self._exit_code)
        return frame

    def _expect_end(self) -> None:
        """Waits for how a worker has ended whose channel is closed."""
        until = time.monotonic() + _ANSWER_S
        while self._exit_code is None:
            if time.monotonic() > until:
                lives = self.pid is not None and read_process(self.pid) is not None
                if lives and not self._keeper.is_stopped:
                    raise ProtocolError("it closed its channel")
                raise KeeperLostError(f"the keeper did not answer within {_ANSWER_S:g} s")
            wait_for((self._control,), _LOOK_S)
            self._hear_keeper()

    def _hear_keeper(self) -> None:
        try:
            while (frame := self._control.read()) is not None:
                match message_of(frame):
                    case Started(pid=pid):
                        self._worker = ProcessHandle(pid)
                        self.pid = pid
                    case Ended(exit_code=exit_code):
                        self._exit_code = exit_code
                    case Strangers(names=names):
                        self._strangers = names
        except (ChannelClosedError, ProtocolError) as error:
            if self._exit_code is None:
                # Its worker is killed with it.
                raise KeeperLostError(f"the keeper of the worker was lost: {error}") from None

    @property
    def is_idle(self) -> bool:
        """Whether the worker lives and has sent nothing that was not asked for."""
        try:
            return self.receive(0.0) is None and not self._channel.is_within_message
        except (WorkerDiedError, KeeperLostError, ProtocolError):
            return False

    def strangers(self) -> tuple[str, ...]:
        """Asks for the processes that live beside the worker and its ADSs; returns their names.

        Raises:
            KeeperLostError: The keeper has ended or does not answer.
        """
        self._strangers = None
        self._control.put(Frame(Kind.LOOK))
        until = time.monotonic() + _ANSWER_S
        while self._strangers is None and self._exit_code is None:
            if time.monotonic() > until or self._keeper.is_stopped:
                raise KeeperLostError("the keeper does not answer")
            wait_for((self._control,), _LOOK_S)
            self._hear_keeper()
        return self._strangers or ()

    def family(self) -> list[int]:
        """Returns the process ids of what was started in the worker and lives, ADSs left out."""
        family = descendants_of(self._keeper.pid, spare=is_guard)
        found = [pid for pid in family if pid != self.pid]
        if not self._keeper.lives:
            return []
        for pid in [pid for pid in self._family if pid not in found]:
            self._family.pop(pid).close()
        for pid in found:
            # Kept for the case that the keeper, which would end them, is lost.
            if pid not in self._family:
                self._family[pid] = ProcessHandle(pid)
        return found

    def end(self) -> None:
        """Ends the worker with all that was started in it, and waits until that is gone."""
        self._control.put(Frame(Kind.END))
        # A keeper that has not started its worker yet need not do so to end it.
        if not (self._has_begun() and self._ends()):
            self.family()
            self._keeper.kill()
            remains = [*self._family.values(), *map(ProcessHandle, self._session())]
            if self._worker is not None:
                remains.append(self._worker)
            for handle in remains:
                handle.kill()
                handle.close()
        self._close()
        forget_process(self._process)

    def _has_begun(self) -> bool:
        with contextlib.suppress(KeeperLostError):
            self._hear_keeper()
        return self.pid is not None

    def _ends(self) -> bool:
        """Waits for the end of the keeper; false if it did not end everything before."""
        until = time.monotonic() + _END_S
        try:
            while time.monotonic() < until and not self._keeper.is_stopped:
                wait_for((self._control,), _LOOK_S)
                self._hear_keeper()
                if self._exit_code is not None and not self._keeper.lives:
                    return True
        except KeeperLostError:
            pass
        return False

    def _session(self) -> list[int]:
        """Returns what is left of the worker's session; its own id is not used again before."""
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
        for handle in self._family.values():
            handle.close()
        self._family.clear()
        if self._worker is not None:
            self._worker.close()
