"""The main loop of a worker process: set-up, then one run after another.

The process that owns the workers imports this module, too; imports that only a worker needs, above
all the simulator, are made where they are used.
"""

from __future__ import annotations

import faulthandler
import os
import pickle
import pkgutil
import socket
import traceback
from collections.abc import Callable
from dataclasses import dataclass, replace

from drivora_service.errors import DrivoraError, SimulatorError
from drivora_service.runs.candidate import Candidate, CandidateSource
from drivora_service.runs.lifecycle import SIMULATOR_ERROR
from drivora_service.runs.run_report import RunFailure, RunReport, RunSpec, RunStatus
from drivora_service.simulation.run_phase import BoardCell, RunPhase
from drivora_service.worker.channel import ChannelClosedError, Frame, Kind, receive, send
from drivora_service.worker.progress_board import ProgressBoard
from drivora_service.worker.worker_messages import (
    NotReady,
    frame_of,
    frame_of_report,
    note_of_candidate,
)

Perform = Callable[[RunSpec, object, ProgressBoard], RunReport]
"""Performs a run, given the spec, the worker's set-up and the board for its progress."""

PERFORM = "drivora_service.worker.performing:perform"
"""The function that performs runs in production."""

Prepare = Callable[[CandidateSource, object], Candidate]
"""Makes a scenario of genes, given the worker's set-up."""

PREPARE = "drivora_service.worker.candidate_preparing:prepare"
"""The function that prepares candidates in production."""

WARM_UP = "drivora_service.worker.worker_warm_up:warm_up"
"""The function that prepares a worker for it; called once with the worker's set-up."""

_NICENESS = 5
"""Workers use all cores; requests to the service shall not wait for them."""


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkerTask:
    """The task of a worker.

    Attributes:
        perform: The :data:`Perform` to use, as ``module:function``.
        warm_up: Function to call first, or "" for none.
        prepare: The :data:`Prepare` to use, as ``module:function``.
        setup: Argument of every call; must be picklable.
    """

    perform: str
    warm_up: str
    setup: object
    prepare: str = PREPARE


def serve(channel: socket.socket, board_file: int, task: WorkerTask) -> None:
    """Performs the runs that arrive on the channel until it is closed.

    Sends a ready message at first and with the report of each run. Leaves what the genes of a run
    mean on the board. If the worker cannot work, sends the reason instead and returns.

    Args:
        channel: The worker's end of the connection with its slot.
        board_file: Descriptor of the memory in which to show progress.
        task: Task of the worker.
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
        report = _report(spec, do, task, board)
        # A report that arrives during a call of an agent is not the worker's own.
        board.cells[BoardCell.PHASE] = RunPhase.IDLE
        # Together, as each wakes the slot.
        send(channel, frame_of_report(report), Frame(Kind.READY))


def _report(spec: RunSpec, perform: Perform, task: WorkerTask, board: ProgressBoard) -> RunReport:
    """Performs one run; an exception becomes its report."""
    try:
        if spec.candidate is not None:
            candidate = _prepare_candidate(spec.candidate, task, board)
            # Before the simulation, which the process may not survive.
            board.leave(note_of_candidate(candidate, spec.run_id))
            if candidate.problem:
                return _make_invalid_report(spec, candidate.problem)
            repaired = replace(spec.candidate, values=candidate.values)
            # An adversary acts while the run is performed.
            acts = spec.candidate.adversary is not None
            spec = replace(
                spec,
                document=candidate.document,
                candidate=repaired,
                prepared=candidate if acts else None,
            )
        return perform(spec, task.setup, board)
    except SimulatorError as error:
        return _make_exception_report(spec, RunStatus.SIMULATOR_CRASHED, SIMULATOR_ERROR, error)
    except SystemExit as error:
        # Nothing in this package exits the process, so it was the code under test.
        return _make_exception_report(spec, RunStatus.AGENT_FAILED, "agent_raised", error)
    except Exception as error:
        return _make_exception_report(spec, RunStatus.INFRASTRUCTURE_FAILED, "worker_error", error)


def _prepare_candidate(
    source: CandidateSource, task: WorkerTask, board: ProgressBoard
) -> Candidate:
    # No agent of this run is there yet.
    board.cells[BoardCell.IN_PROCESS] = 0
    board.cells[BoardCell.PHASE] = RunPhase.PREPARING
    prepare: Prepare = pkgutil.resolve_name(task.prepare)
    return prepare(source, task.setup)


def _make_invalid_report(spec: RunSpec, problem: str) -> RunReport:
    return RunReport(
        run_id=spec.run_id,
        status=RunStatus.INVALID,
        failure=RunFailure(cause="invalid_document", message=problem),
    )


def _make_exception_report(
    spec: RunSpec, status: RunStatus, cause: str, error: BaseException
) -> RunReport:
    return RunReport(
        run_id=spec.run_id,
        status=status,
        failure=RunFailure(
            cause=cause,
            message=f"{type(error).__name__}: {error}",
            log="".join(traceback.format_exception(error)[-12:]),
        ),
    )
