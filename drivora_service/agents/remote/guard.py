"""Runs a command, ends it with all its processes, and keeps a bounded log of its output.

On Linux these are all its descendants; elsewhere, those in its process group.

Started as ``python -I -S guard.py PARENT FOLDER LOG CONFINEMENT COMMAND…``; needs only the
standard library. It ends when the command ends, on SIGTERM, and when the process
PARENT dies in any way. In the last two cases it removes FOLDER. CONFINEMENT is JSON
with the fields of ``Confinement``: the user account and the limits of the command.
"""

from __future__ import annotations

import contextlib
import ctypes
import json
import os
import resource
import select
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from types import FrameType
from typing import Any

LOG_BYTES = 1 << 20
"""Size at which the older half of the log is dropped."""

BEYOND_MEMORY = 120
"""Exit code if the command was ended because it used too much memory."""

_PR_SET_PDEATHSIG, _PR_SET_CHILD_SUBREAPER, _PR_SET_NO_NEW_PRIVS = 1, 36, 38
_CHUNK = 1 << 16
_MEMORY_WATCH_S = 0.25
_DRAINED_S = 0.2


class BoundedLog:
    """A file of which the older half is dropped when it has grown to ``limit`` bytes."""

    def __init__(self, path: Path, limit: int = LOG_BYTES) -> None:
        self._file = path.open("w+b", buffering=0)
        self._limit = limit

    def write(self, data: bytes) -> None:
        """Appends."""
        self._file.write(data)
        if self._file.tell() > self._limit:
            self._file.seek(-self._limit // 2, os.SEEK_END)
            kept = self._file.read()
            self._file.seek(0)
            self._file.write(kept)
            self._file.truncate()

    def close(self) -> None:
        """Closes the file."""
        self._file.close()


def main(
    parent: int, folder: Path, log: BoundedLog, confinement: dict[str, Any], command: list[str]
) -> int:
    """Runs the guard.

    Returns:
        The exit code of the command; 128 plus the number for a signal; or :data:`BEYOND_MEMORY`.
    """
    signal.signal(signal.SIGTERM, _exit_on_signal)
    # Block SIGTERM until the command has started, since there is nothing to end before.
    signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGTERM])
    _die_with_parent(signal.SIGTERM)
    _adopt_orphans()
    output, inlet = os.pipe()
    try:
        child = subprocess.Popen(
            command,
            stdin=subprocess.DEVNULL,
            stdout=inlet,
            stderr=inlet,
            **_account(confinement),
            # After the change of the user, which would reset some of it.
            preexec_fn=lambda: _begin_child(confinement),
        )
    except (OSError, subprocess.SubprocessError) as error:
        log.write(f"the command cannot be started: {error}\n".encode())
        return 127
    os.close(inlet)
    try:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGTERM])
        looked = time.monotonic()
        too_much = False
        while os.getppid() == parent:
            # The end of the command is detected by the end of its output, or, if a process that it
            # started shares that, by a check once a second.
            copied = _copy(output, log, _MEMORY_WATCH_S)
            if time.monotonic() - looked > _MEMORY_WATCH_S:
                looked = time.monotonic()
                used = _memory(_descendants())
                if used > confinement["memory_bytes"]:
                    log.write(
                        f"[ended: {used >> 20} MiB of memory; allowed: "
                        f"{confinement['memory_bytes'] >> 20} MiB "
                        "(DRIVORA_AGENT_MEMORY_MB)]\n".encode()
                    )
                    too_much = True
                    child.kill()
            if copied and child.poll() is None:
                continue
            _reap_orphans(child.pid)
            with contextlib.suppress(subprocess.TimeoutExpired):
                child.wait(_DRAINED_S)
            if child.returncode is not None:
                while _copy(output, log, 0.0) is True:
                    pass
                code = _report_exit(child.returncode, log)
                return BEYOND_MEMORY if too_much else code
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        raise SystemExit(1)
    except SystemExit:
        shutil.rmtree(folder, ignore_errors=True)
        raise
    finally:
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(child.pid, signal.SIGKILL)
        child.wait()
        _end_orphans()


def _copy(output: int, log: BoundedLog, patience: float) -> bool | None:
    """Copies the output of ``patience`` seconds; false at the end, ``None`` without output."""
    ready, _, _ = select.select([output], [], [], patience)
    if not ready:
        return None
    data = os.read(output, _CHUNK)
    log.write(data)
    return bool(data)


def _report_exit(code: int, log: BoundedLog) -> int:
    if code >= 0:
        log.write(f"[exited with code {code}]\n".encode())
        return code
    log.write(f"[ended by {signal.Signals(-code).name}]\n".encode())
    return 128 - code


def _exit_on_signal(_number: int, _frame: FrameType | None) -> None:
    # The kernel signals the death of every thread that was temporarily the parent: the
    # second signal must not interrupt the cleanup after the first.
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    raise SystemExit(0)


def _account(confinement: dict[str, Any]) -> dict[str, Any]:
    """Returns the arguments that start a process under the user account, without further groups."""
    user, group = confinement["user"], confinement["group"]
    return {} if user is None else {"user": user, "group": group, "extra_groups": []}


def _begin_child(confinement: dict[str, Any]) -> None:
    os.setpgid(0, 0)
    limits = [
        (resource.RLIMIT_CORE, 0),
        (resource.RLIMIT_FSIZE, confinement["file_bytes"]),
        (resource.RLIMIT_NOFILE, confinement["files"]),
    ]
    if confinement["user"] is not None:
        limits.append((resource.RLIMIT_NPROC, confinement["processes"]))
    for what, most in limits:
        _, hard = resource.getrlimit(what)
        most = most if hard == resource.RLIM_INFINITY else min(most, hard)
        resource.setrlimit(what, (most, most))
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0)
    _die_with_parent(signal.SIGKILL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGTERM])


def _descendants() -> list[int]:
    """Returns the processes of the command, as far as the system lists them."""
    found, todo = [], _children()
    while todo:
        pid = todo.pop()
        found.append(pid)
        todo += _children(pid)
    return found


def _memory(processes: list[int]) -> int:
    """Returns the resident memory of processes, bytes; shared memory counts in each."""
    pages = 0
    for pid in processes:
        with contextlib.suppress(OSError, ValueError, IndexError):
            pages += int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    return pages * resource.getpagesize()


def _adopt_orphans() -> None:
    """Becomes the parent of all processes that the command leaves, in any group."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)


def _children(of: int | None = None) -> list[int]:
    """Returns the children of a process, of all its threads; by default of this process."""
    found: list[int] = []
    try:
        for children in Path(f"/proc/{of or os.getpid()}/task").glob("*/children"):
            found += map(int, children.read_text().split())
    except OSError:
        pass
    return found


def _reap_orphans(command: int) -> None:
    """Waits for ended adopted processes, which would otherwise remain as zombies."""
    for pid in _children():
        if pid != command:
            with contextlib.suppress(ChildProcessError):
                os.waitpid(pid, os.WNOHANG)


def _end_orphans() -> None:
    """Ends the remaining processes of the command, and those that they leave in turn."""
    beyond_us: set[int] = set()
    while children := set(_children()) - beyond_us:
        for pid in children:
            try:
                os.kill(pid, signal.SIGKILL)
                os.waitpid(pid, 0)
            except PermissionError:
                beyond_us.add(pid)
            except (ProcessLookupError, ChildProcessError):
                pass


def _die_with_parent(number: signal.Signals) -> None:
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, int(number), 0, 0, 0)


if __name__ == "__main__":
    sys.exit(
        main(
            int(sys.argv[1]),
            Path(sys.argv[2]),
            BoundedLog(Path(sys.argv[3])),
            json.loads(sys.argv[4]),
            sys.argv[5:],
        )
    )
