"""The inside of a worker process: set up once, then one run after another.

This module is also imported by the process that owns the workers; what only a worker needs, above
all the simulator, is imported where it is used.
"""

from __future__ import annotations

import faulthandler
import os
import pkgutil
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path

from drivora_service.errors import DrivoraError, SimulatorError
from drivora_service.execution.parent_death import die_with_parent
from drivora_service.runs.lifecycle import SIMULATOR_ERROR
from drivora_service.runs.progress import ProgressBoard
from drivora_service.runs.report import RunFailure, RunReport, RunSpec, RunStatus

Perform = Callable[[RunSpec, object, ProgressBoard], RunReport]
"""What does a run: given the spec, the worker's set-up and the board on which to show progress."""

PERFORM = "drivora_service.runs.performing:perform"
"""Where the real one is."""

WARM_UP = "drivora_service.runs.warm_up:warm_up"
"""What gets a worker ready for it: called once with the worker's set-up."""


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkerFiles:
    """The files by which a worker and its slot know of each other.

    Attributes:
        log: Takes everything that the worker process prints.
        board: See :class:`ProgressBoard`.
    """

    log: Path
    board: Path


@dataclass(frozen=True, slots=True)
class Ready:
    """What a worker sends when it has been set up."""


@dataclass(frozen=True, slots=True)
class NotReady:
    """What a worker sends instead when it cannot be set up; it ends then.

    Attributes:
        reason: What was found and, where it is known, what to do.
    """

    reason: str


def serve(
    channel: Connection, perform: str, warm_up: str, setup: object, files: WorkerFiles
) -> None:
    """Is the worker: does the runs that come through the channel until that is closed.

    Sends :class:`Ready` once, and then the report of each run; or :class:`NotReady`, and ends.

    Args:
        channel: The worker's end of the connection with its slot.
        perform: The :data:`Perform` to use, as ``module:function``.
        warm_up: What to call first, or "" for nothing.
        setup: What it gets with every run.
        files: Where to log and to show progress.
    """
    die_with_parent()
    # A session of its own: an interrupt typed at a terminal is the server's to handle, and whatever
    # an agent starts can be ended together with the worker.
    os.setsid()
    log = os.open(files.log, os.O_WRONLY | os.O_CREAT | os.O_APPEND)
    os.dup2(log, 1)
    os.dup2(log, 2)
    os.close(log)
    faulthandler.enable()
    board = ProgressBoard(files.board)
    board.cells[:] = 0
    try:
        if warm_up:
            pkgutil.resolve_name(warm_up)(setup)
        do: Perform = pkgutil.resolve_name(perform)
    except Exception as error:
        traceback.print_exc()
        known = isinstance(error, DrivoraError)
        channel.send(NotReady(str(error) if known else f"{type(error).__name__}: {error}"))
        return
    channel.send(Ready())
    while True:
        try:
            spec = channel.recv()
        except EOFError:
            return
        channel.send(_work(do, spec, setup, board))


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
