"""A program `drivora` for the scripts of pages, whose commands come from the fork server of tests.

A command that a shell starts imports the package, and so does the fork server of its workers: some
seconds a command, of which the pages have more than a hundred. The program passes its arguments,
folder, environment and outputs to the process of the tests, which has the fork server begin the
command, and ends as that ends. A signal that it gets, the command gets, too.
"""

from __future__ import annotations

import contextlib
import json
import signal
import socket
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from tests.command_process import Begun, begin

_PROGRAM = """\
#!{python} -IS
import json, os, signal, socket, sys

server = socket.socket(socket.AF_UNIX)
server.connect({address!r})

request = (os.getpid(), sys.argv[1:], os.getcwd(), dict(os.environ))
server.sendall(json.dumps(request).encode() + b"\\n")
for number in (signal.SIGINT, signal.SIGTERM):
    if signal.getsignal(number) is not signal.SIG_IGN:
        signal.signal(number, lambda number, frame: server.sendall(bytes([number])))
code = int(server.recv(20))
if code < 0:
    signal.signal(-code, signal.SIG_DFL)
    os.kill(os.getpid(), -code)
sys.exit(code)
"""


@contextmanager
def forked_drivora() -> Iterator[Path]:
    """Yields a folder with the program; ends the commands that it has begun and that still run."""
    # Addresses of sockets are short: at most 107 bytes.
    with tempfile.TemporaryDirectory() as name, socket.socket(socket.AF_UNIX) as listener:
        folder = Path(name)
        listener.bind(str(folder / "socket"))
        listener.listen()
        (folder / "bin").mkdir()
        program = folder / "bin" / "drivora"
        program.write_text(_PROGRAM.format(python=sys.executable, address=str(folder / "socket")))
        program.chmod(0o755)
        threads: list[threading.Thread] = []
        accepting = threading.Thread(target=_accept, args=(listener, threads))
        accepting.start()
        try:
            yield folder / "bin"
        finally:
            # It wakes the thread that waits for connections; closing it alone does not.
            listener.shutdown(socket.SHUT_RDWR)
            accepting.join()
            for thread in threads:
                thread.join()


def _accept(listener: socket.socket, threads: list[threading.Thread]) -> None:
    while True:
        try:
            connection, _ = listener.accept()
        except OSError:
            return
        threads.append(threading.Thread(target=_attend, args=(connection,)))
        threads[-1].start()


def _attend(connection: socket.socket) -> None:
    """Begins the command of a program; sends it signals, and the program its exit code."""
    with connection, connection.makefile("rb") as requests:
        line = requests.readline()
        if not line:
            return
        pid, arguments, folder, environment = json.loads(line)
        outputs = Path(f"/proc/{pid}/fd")
        with _lock:
            begun = begin(
                *arguments,
                folder=Path(folder),
                environment=environment,
                out=outputs / "1",
                err=outputs / "2",
            )
        ended = threading.Event()
        passing = threading.Thread(target=_pass_signals, args=(requests, begun, ended))
        passing.start()
        while (code := _exit_code(begun)) is None:
            time.sleep(0.02)
        ended.set()
        # Where the program was killed, there is no connection any more.
        with contextlib.suppress(OSError):
            connection.sendall(str(code).encode())
            connection.shutdown(socket.SHUT_RDWR)
        passing.join()


_lock = threading.Lock()
"""Of the processes of `multiprocessing`: to start one asks all others whether they have ended."""


def _exit_code(begun: Begun) -> int | None:
    with _lock:
        return begun.poll()


def _pass_signals(requests: BinaryIO, begun: Begun, ended: threading.Event) -> None:
    """Sends a command the signals that its program gets; kills it if the program was killed."""
    while True:
        number = (requests.read(1) or bytes([signal.SIGKILL]))[0]
        if ended.is_set():
            return
        with contextlib.suppress(ProcessLookupError):
            begun.send_signal(signal.Signals(number))
        if number == signal.SIGKILL:
            return
