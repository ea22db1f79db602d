"""The inside of a worker process: set up once, then one run after another.

This module is also imported by the process that owns the workers; what only a worker needs, above
all the simulator, is imported where it is used.
"""

from __future__ import annotations

import faulthandler
import os
import pickle
import pkgutil
import socket
import traceback
from collections.abc import Callable
from dataclasses import dataclass

from drivora_service.errors import DrivoraError, SimulatorError
from drivora_service.runs.lifecycle import SIMULATOR_ERROR
from drivora_service.runs.report import RunFailure, RunReport, RunSpec, RunStatus
from drivora_service.simulation.phase import RunPhase
from drivora_service.worker.channel import ChannelClosedError, Frame, Kind, receive, send
from drivora_service.worker.messages import NotReady, frame_of, frame_of_report
from drivora_service.worker.progress import ProgressBoard

Perform = Callable[[RunSpec, object, ProgressBoard], RunReport]
"""What does a run: given the spec, the worker's set-up and the board on which to show progress."""

PERFORM = "drivora_service.worker.performing:perform"
"""Where the real one is."""

WARM_UP = "drivora_service.worker.warm_up:warm_up"
"""What gets a worker ready for it: called once with the worker's set-up."""


_NICENESS = 5
"""Workers use all cores there are; requests to the service shall not wait for that."""


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkerTask:
    """What a worker does.

    Attributes:
        perform: The :data:`Perform` to use, as ``module:function``.
        warm_up: What to call first, or "" for nothing.
        setup: What it gets with every run; must be picklable.
    """

    perform: str
    warm_up: str
    setup: object


def serve(channel: socket.socket, board_file: int, task: WorkerTask) -> None:
    """Is the worker: does the runs that come through the channel until that is closed.

    Sends that it is ready, at first and after the report of each run; or why it is not, and
    returns.

    Args:
        channel: The worker's end of the connection with its slot.
        board_file: Descriptor of the memory in which to show progress.
        task: What to do.
    """
    faulthandler.enable()
    os.nice(_NICENESS)
    board = ProgressBoard(board_file)
    os.close(board_file)
    try:
        if task.warm_up:
            pkgutil.resolve_name(task.warm_up)(task.setup)
        do: Perform = pkgutil.resolve_name(task.perform)
    except Exception as error:
        traceback.print_exc()
        known = isinstance(error, DrivoraError)
        reason = str(error) if known else f"{type(error).__name__}: {error}"
        send(channel, frame_of(NotReady(reason=reason)))
        return
    send(channel, Frame(Kind.READY))
    while True:
        try:
            frame = receive(channel)
        except ChannelClosedError:
            return
        spec: RunSpec = pickle.loads(frame.body)
        report = _work(do, spec, task.setup, board)
        # A report that comes while an agent is called is not the worker's own.
        board.cells[0] = RunPhase.IDLE
        send(channel, frame_of_report(report))
        send(channel, Frame(Kind.READY))


def _work(perform: Perform, spec: RunSpec, setup: object, board: ProgressBoard) -> RunReport:
    """Does one run; whatever it raises becomes its report."""
    try:
        return perform(spec, setup, board)
    except SimulatorError as error:
        return _raised(spec, RunStatus.SIMULATOR_CRASHED, SIMULATOR_ERROR, error)
    except SystemExit as error:
        # Nothing of ours ends the process, so it was the code under test.
        return _raised(spec, RunStatus.AGENT_FAILED, "agent_raised", error)
    except Exception as error:
        return _raised(spec, RunStatus.INFRASTRUCTURE_FAILED, "worker_error", error)


def _raised(spec: RunSpec, status: RunStatus, cause: str, error: BaseException) -> RunReport:
    return RunReport(
        run_id=spec.run_id,
        status=status,
        failure=RunFailure(
            cause=cause,
            message=f"{type(error).__name__}: {error}",
            log="".join(traceback.format_exception(error)[-12:]),
        ),
    )
