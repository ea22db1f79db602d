"""Commands in processes of their own, from the fork server of the tests."""

from __future__ import annotations

import multiprocessing
import os
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from multiprocessing import forkserver
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any
from unittest import mock

import typer.main

from drivora_service.worker.process_readings import ProcessHandle


@dataclass(slots=True)
class Begun:
    """A command that may not have ended, with the methods of `subprocess.Popen`.

    Some tests end the fork server, which alone knows exit codes. A command that goes on without it
    has not ended, though `multiprocessing` then says that it has.
    """

    process: BaseProcess
    _handle: ProcessHandle = field(init=False)

    def __post_init__(self) -> None:
        assert self.process.pid is not None
        self._handle = ProcessHandle(self.process.pid)
        # Else hundreds would stay open. The time of its start identifies the process as well.
        self._handle.close()

    def poll(self) -> int | None:
        """Its exit code, if it has ended."""
        code = self.process.exitcode
        return None if code is not None and self._handle.lives else code

    def wait(self, timeout: float | None = None) -> int:
        """Waits for its end, and returns its exit code."""
        until = None if timeout is None else time.monotonic() + timeout
        self.process.join(timeout)
        while (code := self.poll()) is None:
            if until is not None and time.monotonic() >= until:
                raise TimeoutError
            time.sleep(0.02)
        return code

    def kill(self) -> None:
        """Kills it, and waits until it is gone."""
        self._handle.kill()
        self.wait()

    def send_signal(self, number: int) -> None:
        """Sends it a signal."""
        assert self.process.pid is not None
        os.kill(self.process.pid, number)


def begin(
    *arguments: str | Path,
    folder: Path,
    environment: Mapping[str, str],
    out: Path,
    err: Path,
    umask: int | None = None,
) -> Begun:
    """Starts ``drivora`` with these arguments, and does not wait for it.

    Args:
        arguments: What follows ``drivora``.
        folder: The folder in which it runs.
        environment: Its environment.
        out: File to which it prints; it is appended to.
        err: File of its errors; may be the same.
        umask: Its umask; ``None``: that of the fork server.
    """
    process = multiprocessing.get_context("forkserver").Process(
        target=_run_command,
        args=(
            [*map(str, arguments)],
            folder,
            dict(environment),
            out,
            err,
            umask,
            fork_server_address(),
        ),
    )
    process.start()
    return Begun(process)


def fork_server_address() -> str:
    """Returns the address of the fork server of this process, which is started if need be."""
    forkserver.ensure_running()
    address: str = _fork_server()._forkserver_address
    return address


def _run_command(
    arguments: Sequence[str],
    folder: Path,
    environment: dict[str, str],
    out: Path,
    err: Path,
    umask: int | None,
    address: str,
) -> None:
    """Is ``drivora`` with these arguments: ends as it does, with its exit code.

    Its workers come from the fork server at an address.
    """
    use_fork_server(address)
    os.chdir(folder)
    os.environ.clear()
    os.environ.update(environment)
    # The folder of the fork server, if that has asked for it.
    tempfile.tempdir = None
    # As a process that is started has it; what it starts gets it from here.
    added = environment.get("PYTHONPATH", "").split(os.pathsep)
    sys.path[:0] = [path for path in added if path and path not in sys.path]
    for path, descriptor in ((out, 1), (err, 2)):
        file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_APPEND)
        os.dup2(file, descriptor)
        os.close(file)
    if umask is not None:
        os.umask(umask)
    sys.argv = ["drivora", *arguments]
    from drivora_service.cli.main import app
    from tests.built_commands import COMMANDS

    with mock.patch.object(typer.main, "get_command", return_value=COMMANDS):
        app()


def use_fork_server(address: str) -> None:
    """Uses a fork server that runs; one for each command would only repeat its imports.

    Commands that a shell starts, as the pages of the documentation do, have one of their own.
    """
    server = _fork_server()
    server._forkserver_address = address
    # It is not a child of this process, which therefore cannot ask whether it lives.
    server.ensure_running = lambda: None
    vars(forkserver)["ensure_running"] = server.ensure_running


def _fork_server() -> Any:
    return vars(forkserver)["_forkserver"]
