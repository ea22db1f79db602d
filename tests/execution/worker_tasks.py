"""What the workers of the tests do: the document of a spec names it."""

from __future__ import annotations

import ctypes
import os
import signal
import sys
import time
from pathlib import Path

from drivora_service.errors import SimulatorError
from drivora_service.runs.progress import ProgressBoard
from drivora_service.runs.report import RunFailure, RunReport, RunSpec, RunStatus
from drivora_service.simulation.phase import Phase


def perform(spec: RunSpec, setup: object, board: ProgressBoard) -> RunReport:
    """Does what the first word of the document says, with the second as its argument."""
    word, _, argument = spec.document.partition(" ")
    board.cells[3] += 1
    board.cells[0] = Phase.SIMULATING
    match word:
        case "sleep":
            time.sleep(float(argument))
        case "writes-trace":
            time.sleep(float(argument))
            try:
                Path(spec.trace_path).write_bytes(b"trace")
            except OSError as error:
                failure = RunFailure(cause="trace_not_written", message=str(error))
                return RunReport(
                    run_id=spec.run_id, status=RunStatus.INFRASTRUCTURE_FAILED, failure=failure
                )
        case "burn":
            end = time.perf_counter() + float(argument)
            while time.perf_counter() < end:
                pass
        case "segfault":
            print("about to touch address zero", flush=True)
            ctypes.string_at(0)
        case "agent-segfault":
            _call_agent(board)
            ctypes.string_at(0)
        case "agent-hangs":
            _call_agent(board)
            while True:
                pass
        case "agent-hangs-in-c":
            _call_agent(board)
            # Keeps the interpreter to itself: no handler or thread of this process runs any more.
            ctypes.PyDLL(None).sleep(3600)
        case "hangs":
            time.sleep(3600)
        case "grows" | "agent-grows":
            if word == "agent-grows":
                _call_agent(board)
            kept = []
            while True:
                kept.append(bytearray(os.urandom(1 << 20)) * 8)
                time.sleep(0.005)
        case "kill-self":
            os.kill(os.getpid(), signal.SIGKILL)
        case "exit":
            os._exit(int(argument))
        case "agent-calls-exit":
            sys.exit(int(argument))
        case "raises":
            raise ValueError(argument)
        case "simulator-error":
            raise SimulatorError(argument)
        case "spawns":
            if os.fork() == 0:
                time.sleep(3600)
            ctypes.string_at(0)
        case "agent-spawns-and-hangs":
            _call_agent(board)
            if os.fork() == 0:
                time.sleep(3600)
            time.sleep(3600)
        case "writes-board":
            board.cells[:] = [int(cell) for cell in argument.split()]
            time.sleep(0.3)
        case "environment":
            return _finished(spec, dict(os.environ))
        case "crash-once":
            try:
                os.open(argument, os.O_CREAT | os.O_EXCL)
            except FileExistsError:
                return _finished(spec, {})
            os.kill(os.getpid(), signal.SIGSEGV)
    board.cells[0] = Phase.IDLE
    return _finished(spec, {"pid": str(os.getpid()), "setup": str(setup)})


def _call_agent(board: ProgressBoard) -> None:
    board.cells[1], board.cells[2] = 17, 2
    board.cells[0] = Phase.IN_AGENT


def _finished(spec: RunSpec, versions: dict[str, str]) -> RunReport:
    return RunReport(run_id=spec.run_id, status=RunStatus.FINISHED, versions=versions)


def start_if_there(needed: Path) -> None:
    """A warm-up that fails as long as a file is not there."""
    if not needed.exists():
        raise OSError(f"a worker needs {needed.name}")


def die(_needed: Path) -> None:
    """A warm-up in which the system ends the worker."""
    os.kill(os.getpid(), signal.SIGKILL)


def die_once(needed: Path) -> None:
    """The same, the first time."""
    if not needed.exists():
        needed.touch()
        die(needed)
