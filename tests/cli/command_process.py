"""What runs in the process of a command."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from multiprocessing import forkserver
from pathlib import Path
from typing import Any


def fork_server_address() -> str:
    """Returns the address of the fork server of this process, which is started if need be."""
    forkserver.ensure_running()
    address: str = _fork_server()._forkserver_address
    return address


def run_command(
    arguments: Sequence[str],
    folder: Path,
    environment: dict[str, str],
    out: Path,
    err: Path,
    address: str,
) -> None:
    """Is ``drivora`` with these arguments: ends as it does, with its exit code.

    Its workers come from the fork server at an address.
    """
    _use_fork_server(address)
    os.chdir(folder)
    os.environ.clear()
    os.environ.update(environment)
    for path, descriptor in ((out, 1), (err, 2)):
        file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(file, descriptor)
        os.close(file)
    sys.argv = ["drivora", *arguments]
    from drivora_service.cli.main import app

    app()


def _use_fork_server(address: str) -> None:
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
