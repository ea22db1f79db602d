"""Environments of other simulators, and conversations with processes in them."""

from __future__ import annotations

import hashlib
import json
import shutil
import subprocess
import sys
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from drivora_service.errors import DrivoraError

_INSTALL_S = 1200.0
_FIRST_S = 300.0
"""Longest duration of a peer's start with its first round."""
_STAMP = "installed"


class PeerError(DrivoraError):
    """Another simulator cannot be installed, or fails."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Answer:
    """The answer of a peer to a round.

    Attributes:
        simulated: Simulated seconds.
        needed: Processor seconds that it took.
        vehicles: Number of vehicles beside the ego.
    """

    simulated: float
    needed: float
    vehicles: int

    @property
    def times_real(self) -> float:
        """Simulated seconds a processor second."""
        return self.simulated / self.needed


def prepare_environment(requirements: Path, cache: Path, *, install: bool) -> Path:
    """Returns the interpreter of an environment with pinned packages; makes it if there is none.

    Args:
        requirements: File of the packages.
        cache: Folder of the environments.
        install: Whether to make it if there is none.

    Raises:
        PeerError: It cannot be made; the message is the reason.
    """
    identity = hashlib.sha256(requirements.read_bytes() + sys.version.encode()).hexdigest()[:16]
    folder = cache / f"{requirements.stem}-{identity}"
    python = folder / "bin" / "python"
    if (folder / _STAMP).is_file():
        return python
    if not install:
        raise PeerError("the short form installs nothing")
    shutil.rmtree(folder, ignore_errors=True)
    pip = [str(python), "-m", "pip", "install", "--quiet", "--no-input", "--no-deps"]
    for command in (
        [sys.executable, "-m", "venv", str(folder)],
        [*pip, "--disable-pip-version-check", "-r", str(requirements)],
    ):
        try:
            done = subprocess.run(
                command, capture_output=True, text=True, timeout=_INSTALL_S, check=False
            )
        except subprocess.TimeoutExpired:
            raise PeerError(f"its installation took more than {_INSTALL_S:g} s") from None
        if done.returncode != 0:
            raise PeerError(f"it cannot be installed: {_last_line(done.stderr)}")
    (folder / _STAMP).touch()
    return python


class Peer:
    """A process that simulates a round for every line that it gets."""

    def __init__(self, process: subprocess.Popen[str], log: Path) -> None:
        """Takes a started process.

        Args:
            process: Its input and output are pipes.
            log: File of its errors.
        """
        self._process, self._log = process, log

    def run_round(self) -> Answer:
        """Returns the answer to a round.

        Raises:
            PeerError: The process failed.
        """
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        alarm = threading.Timer(_FIRST_S, self._process.kill)
        alarm.start()
        try:
            self._process.stdin.write("\n")
            self._process.stdin.flush()
            line = self._process.stdout.readline()
        except BrokenPipeError:
            line = ""
        finally:
            alarm.cancel()
        if not line:
            self._process.wait()
            raise PeerError(f"it failed: {_last_line(self._log.read_text())}")
        return Answer(**json.loads(line))


@contextmanager
def start_peer(python: Path, script: Path, arguments: Sequence[str], log: Path) -> Iterator[Peer]:
    """Starts a peer; ends it afterwards."""
    with (
        log.open("w") as errors,
        subprocess.Popen(
            [str(python), str(script), *arguments],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=errors,
            text=True,
        ) as process,
    ):
        try:
            yield Peer(process, log)
        finally:
            process.kill()


def _last_line(text: str) -> str:
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    return lines[-1] if lines else "it said nothing"
