"""Tasks of the workers of the tests, named by the document of a spec."""

from __future__ import annotations

import ctypes
import json
import os
import pickle
import signal
import socket
import struct
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

from drivora_service.errors import SimulatorError
from drivora_service.runs.run_report import RunFailure, RunReport, RunSpec, RunStatus
from drivora_service.simulation.run_phase import BoardCell, RunPhase
from drivora_service.worker import keeper
from drivora_service.worker.channel import Frame, send
from drivora_service.worker.progress_board import ProgressBoard


def perform_candidate(spec: RunSpec, setup: object, board: ProgressBoard) -> RunReport:
    """Performs the task that the run's id names; its document is decoded from genes."""
    if spec.run_id.startswith("forges"):
        board.leave(f'{spec.run_id}\n{{"values": []}}'.encode())
    return perform(replace(spec, document=spec.run_id.rpartition(" ")[0]), setup, board)


def perform(spec: RunSpec, setup: object, board: ProgressBoard) -> RunReport:
    """Performs the task of the document's first word, with the second as its argument."""
    word, _, argument = spec.document.partition(" ")
    board.cells[BoardCell.RUN] += 1
    board.cells[BoardCell.IN_PROCESS] = 0
    board.cells[BoardCell.PHASE] = RunPhase.SIMULATING
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
        case "agent-sleeps":
            _call_agent(board)
            time.sleep(float(argument))
        case "agent-stops-itself":
            _call_agent(board)
            os.kill(os.getpid(), signal.SIGSTOP)
        case "sends" | "agent-sends":
            if word == "agent-sends":
                _call_agent(board)
            _send(spec, *argument.split())
            time.sleep(3600)
        case "sends-twice":
            _channel().sendall(_frame(4, _report(spec)))
            # The worker's own report follows when the next run could long have been handed over.
            time.sleep(0.5)
        case "sends-like-finished":
            body = b'{"run_id":"%s","status":"finished","steps":"many"}' % spec.run_id.encode()
            board.cells[BoardCell.PHASE] = RunPhase.IDLE
            _channel().sendall(_frame(4, body) + _frame(1, b""))
            time.sleep(3600)
        case "daemonizes":
            _daemonize(Path(argument))
        case "daemonizes-and-crashes":
            _daemonize(Path(argument))
            ctypes.string_at(0)
        case "child-grows":
            _call_agent(board)
            grow = "import time; kept = bytearray(b'x') * (500 << 20); time.sleep(3600)"
            subprocess.run([sys.executable, "-c", grow], check=True)
        case "forks-and-idles":
            _call_agent(board)
            shared = bytearray(os.urandom(1 << 20)) * int(argument)
            children = [pid for pid in (os.fork() for _ in range(3)) if pid]
            time.sleep(4)
            if len(children) < 3:
                os._exit(len(shared) % 1)
            for pid in children:
                os.waitpid(pid, 0)
        case "floods":
            until = time.monotonic() + float(argument)
            while time.monotonic() < until:
                os.write(1, b"again and again\n" * 4096)
            # What is printed in the moment of a cut is lost.
            time.sleep(0.5)
            print("the last words", flush=True)
        case "replaces-log":
            log, target = argument.split()
            Path(log).unlink()
            Path(log).symlink_to(target)
            print("something new", flush=True)
            os._exit(3)
        case "reports":
            status, _, where = argument.partition(" ")
            board.cells[BoardCell.IN_PROCESS] = where == "in-process"
            return RunReport(
                run_id=spec.run_id,
                status=RunStatus(status),
                failure=RunFailure(cause="of_a_test", message="as asked"),
            )
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
    board.cells[BoardCell.PHASE] = RunPhase.IDLE
    return _finished(spec, {"pid": str(os.getpid()), "setup": str(setup)})


def _channel() -> socket.socket:
    """Finds the worker's end of its channel, as code under test could."""
    for file in Path("/proc/self/fd").iterdir():
        try:
            if str(file.readlink()).startswith("socket:"):
                return socket.socket(fileno=os.dup(int(file.name)))
        except OSError:
            continue
    raise AssertionError("the worker has no socket")


def _frame(kind: int, body: bytes, length: int | None = None) -> bytes:
    return struct.pack("!4sII", b"drvr", kind, len(body) if length is None else length) + body


def _report(spec: RunSpec, **changes: object) -> bytes:
    fields = {"run_id": spec.run_id, "status": "finished", **changes}
    return json.dumps(fields).encode()


class _Touch:
    """Makes a file when it is unpickled."""

    def __init__(self, path: str) -> None:
        self.path = path

    def __reduce__(self) -> tuple[object, ...]:
        return os.mknod, (self.path,)


def _send(spec: RunSpec, what: str, argument: str = "") -> None:
    channel = _channel()
    match what:
        case "header":
            channel.sendall(_frame(4, b"", length=1000))
        case "huge":
            channel.sendall(_frame(4, b"much", length=2**32 - 1))
        case "pickle":
            body = pickle.dumps(_Touch(argument))
            channel.sendall(struct.pack("!i", len(body)) + body)
        case "framed-pickle":
            channel.sendall(_frame(4, pickle.dumps(_Touch(argument))))
        case "kind":
            channel.sendall(_frame(77, b""))
        case "ready":
            channel.sendall(_frame(1, b""))
        case "other-run":
            channel.sendall(_frame(4, _report(spec, run_id="another")))
        case "not-final":
            channel.sendall(_frame(4, _report(spec, status="running")))
        case "many-steps":
            channel.sendall(_frame(4, _report(spec, steps=2**80)))
        case "no-schema":
            channel.sendall(_frame(4, b'{"status": ["finished"]}'))
        case "deep":
            channel.sendall(_frame(4, b"[" * 1_000_000))
        case "own-report":
            channel.sendall(_frame(4, _report(spec)))
        case "nothing-more":
            channel.shutdown(socket.SHUT_RDWR)


def _daemonize(note: Path) -> None:
    """Starts a process that leaves the session and has no parent here; notes its id."""
    if os.fork() == 0:
        os.setsid()
        if os.fork() == 0:
            note.write_text(str(os.getpid()))
            time.sleep(3600)
        os._exit(0)
    os.wait()
    while not note.exists() or not note.read_text():
        time.sleep(0.01)


def _call_agent(board: ProgressBoard) -> None:
    board.cells[BoardCell.STEP], board.cells[BoardCell.EGO] = 17, 2
    board.cells[BoardCell.IN_PROCESS] = 1
    board.cells[BoardCell.PHASE] = RunPhase.IN_AGENT


def _finished(spec: RunSpec, versions: dict[str, str]) -> RunReport:
    return RunReport(run_id=spec.run_id, status=RunStatus.FINISHED, versions=versions)


def start_if_there(needed: Path) -> None:
    """A warm-up that fails as long as a file is missing."""
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


def keep_late(*handed: Any) -> None:
    """A keeper that says only after a while which process its worker is."""

    def send_late(end: socket.socket, *frames: Frame) -> None:
        time.sleep(0.5)
        send(end, *frames)

    # Only in this process, which ends with its worker.
    keeper.send = send_late  # type: ignore[attr-defined]  # a name that it imported
    keeper.keep(*handed)
