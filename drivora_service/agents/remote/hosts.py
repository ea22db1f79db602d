"""Hosts of ADSs: processes that are started here, or addresses of ADSs that run elsewhere."""

from __future__ import annotations

import contextlib
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Protocol

import grpc

from drivora_service.agents.manifest import AgentManifest, command_line
from drivora_service.agents.remote import guard
from drivora_service.agents.remote.confinement import Confinement, variables_for
from drivora_service.agents.remote.connection import Connection
from drivora_service.agents.remote.protocol import ADDRESS_VARIABLE, VERSION
from drivora_service.errors import AgentError

_PACKAGE = Path(__file__).resolve().parents[2]
_TAIL_BYTES = 8192
_TAIL_LINES = 40
_LOOK_S = 0.02
_LONGEST_SOCKET_PATH = 107
"""Bytes of the path of a Unix socket, without the closing zero (unix(7))."""
_SCRATCH = "own"
"""Writable part of an ADS's folder."""
_SHORT_FOLDER = "/tmp"
"""Folder of sockets if the path of the temporary folder is too long for them."""
_ASK_S = 5.0
_END_S = 5.0
_ENDING_S = 5.0
_PRINTED_S = 0.2


class Host(Protocol):
    """The host of an agent's ADS.

    Attributes:
        connection: Connection to the ADS.
    """

    connection: Connection

    @property
    def is_alive(self) -> bool:
        """Whether the ADS can be called."""
        ...

    def tail(self) -> str:
        """Returns the last lines that the ADS printed."""
        ...

    def describe_end(self) -> str:
        """Returns how the ADS ended by itself, "" if it did not or that is unknown."""
        ...

    @property
    def death(self) -> str:
        """Cause of a failure by the end of the ADS."""
        ...

    def end(self) -> None:
        """Ends the ADS with all its processes and removes its files."""
        ...


def _make_socket_folder() -> Path:
    """Makes a folder for temporary files in which a socket's path is not too long."""
    prefix, drawn, socket = "drivora-agent-", 8, f"{_SCRATCH}/socket"
    parent = tempfile.gettempdir()
    if len(os.fsencode(parent)) + len(prefix) + drawn + len(socket) + 2 > _LONGEST_SOCKET_PATH:
        parent = _SHORT_FOLDER
    return Path(tempfile.mkdtemp(prefix=prefix, dir=parent))


def _make_start_error(manifest: AgentManifest, error: OSError) -> AgentError:
    return AgentError(
        f"the process of agent {manifest.name!r} cannot be started: {error}", cause="agent_died"
    )


class ProcessHost:
    """An ADS in a process that is started here, on a socket in its own folder."""

    def __init__(self, manifest: AgentManifest, python: Path, confinement: Confinement) -> None:
        """Starts the ADS and waits until it answers.

        Args:
            manifest: Manifest of the ADS.
            python: Its interpreter.
            confinement: Its user account and limits.

        Raises:
            AgentError: It ends before, does not answer in time, or speaks another protocol.
        """
        self._name = manifest.name
        try:
            self._folder = _make_socket_folder()
        except OSError as error:
            raise _make_start_error(manifest, error) from error
        self._log = self._folder / "log"
        self._last_words = ""
        self._confinement = confinement
        self._scratch = self._folder / _SCRATCH
        socket = self._scratch / "socket"
        address = f"unix:{socket}"
        try:
            self._process = self._start(manifest, python, address)
        except OSError as error:
            shutil.rmtree(self._folder, ignore_errors=True)
            raise _make_start_error(manifest, error) from error
        self.connection = Connection(address)
        try:
            self._wait_until_ready(socket, manifest.deadlines.start)
        except BaseException:
            self.end()
            raise

    def _start(
        self, manifest: AgentManifest, python: Path, address: str
    ) -> subprocess.Popen[bytes]:
        return subprocess.Popen(
            [
                sys.executable, "-I", "-S", guard.__file__, str(os.getpid()), str(self._folder),
                str(self._log), self._confinement.text(), *command_line(manifest, python),
            ],
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
            cwd=manifest.folder, env=self._make_environment(manifest, address),
            start_new_session=True,
        )  # fmt: skip

    def _make_environment(self, manifest: AgentManifest, address: str) -> dict[str, str]:
        """Returns the variables for the ADS; creates their folders.

        The ADS finds ``drivora_service`` in a folder without other packages: the folder where it is
        installed has packages of versions that the ADS did not require.
        """
        packages = self._folder / "packages"
        packages.mkdir()
        (packages / _PACKAGE.name).symlink_to(_PACKAGE, target_is_directory=True)
        self._scratch.mkdir(mode=0o700)
        kept = variables_for(dict(os.environ), scratch=self._scratch, settings=manifest.settings)
        user, group = self._confinement.user, self._confinement.group
        if user is not None and group is not None:
            os.chown(self._scratch, user, group)
            # It may pass through to its own folder, but not list this one.
            self._folder.chmod(0o711)
            packages.chmod(0o755)
            kept.update(HOME=str(self._scratch))
            kept.pop("USER", None)
            kept.pop("LOGNAME", None)
        kept.update(manifest.variables)
        paths = (str(packages), kept.get("PYTHONPATH", ""))
        kept["PYTHONPATH"] = os.pathsep.join(path for path in paths if path)
        kept[ADDRESS_VARIABLE] = address
        return kept

    def _wait_until_ready(self, socket: Path, deadline: float) -> None:
        until = time.monotonic() + deadline
        while time.monotonic() < until:
            if not self.is_alive:
                raise self._error(self.death, f"{self.describe_end()} before it answered")
            if socket.exists():
                left = until - time.monotonic()
                with contextlib.suppress(grpc.RpcError):
                    check_protocol(self, self._name, min(left, _ASK_S))
                    return
            time.sleep(_LOOK_S)
        raise self._error("agent_unreachable", f"did not answer Describe within {deadline:g} s")

    def _error(self, cause: str, what: str) -> AgentError:
        return AgentError(
            f"the process of agent {self._name!r} {what}", cause=cause, log=self.tail()
        )

    @property
    def is_alive(self) -> bool:
        """Whether the process has not ended."""
        return self._process.poll() is None

    def tail(self) -> str:
        """Returns the last lines that the ADS printed; after its end the kept ones."""
        if self.is_alive:
            # The latest output may still be in the guard.
            time.sleep(_PRINTED_S)
        try:
            with self._log.open("rb") as log:
                log.seek(max(0, log.seek(0, os.SEEK_END) - _TAIL_BYTES))
                text = log.read().decode(errors="replace")
        except FileNotFoundError:
            return self._last_words
        return "\n".join(text.splitlines()[-_TAIL_LINES:])

    def describe_end(self) -> str:
        """Returns how the process ended; waits briefly, as its socket closes before its end."""
        try:
            code = self._process.wait(_ENDING_S)
        except subprocess.TimeoutExpired:
            return ""
        if code == guard.BEYOND_MEMORY:
            return "was ended because it took more memory than it may"
        if code < 0:
            return f"was ended because its guard was, by {signal.Signals(-code).name}"
        if code > 128:
            with contextlib.suppress(ValueError):
                return f"was ended by {signal.Signals(code - 128).name}"
        return f"exited with code {code}"

    @property
    def death(self) -> str:
        """Cause of a failure by the end of the ADS.

        A program's own faults do not end it by SIGKILL; the kernel does so if memory is short.
        """
        killed = self._process.poll() in (128 + signal.SIGKILL, -signal.SIGKILL)
        return "agent_killed" if killed else "agent_died"

    def end(self) -> None:
        """Ends the process with all its descendants; removes its socket and its folder."""
        self.connection.close()
        self._last_words = self.tail()
        self._process.terminate()
        try:
            self._process.wait(_END_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        shutil.rmtree(self._folder, ignore_errors=True)


class AddressHost:
    """An ADS that runs elsewhere."""

    def __init__(self, manifest: AgentManifest) -> None:
        """Waits until the ADS answers.

        Raises:
            AgentError: It does not, or it speaks another protocol.
        """
        self._address = manifest.address
        self.connection = Connection(manifest.address)
        self.is_alive = True
        try:
            check_protocol(self, manifest.name, manifest.deadlines.start)
        except grpc.RpcError as error:
            self.end()
            raise AgentError(
                f"agent {manifest.name!r} did not answer at {manifest.address} within "
                f"{manifest.deadlines.start:g} s: {error.details()}. Its operator must start it "
                "before",
                cause="agent_unreachable",
            ) from error
        except AgentError:
            self.end()
            raise

    def tail(self) -> str:
        """Returns where the log is."""
        return f"[the log is with the operator of the ADS at {self._address}]"

    def describe_end(self) -> str:
        """Returns "": how an ADS elsewhere ended is unknown."""
        return ""

    @property
    def death(self) -> str:
        """Cause of a failure by the end of the ADS."""
        return "agent_died"

    def end(self) -> None:
        """Closes the connection only."""
        self.is_alive = False
        self.connection.close()


def check_protocol(host: Host, name: str, timeout: float) -> None:
    """Checks the protocol version of an ADS.

    Raises:
        grpc.RpcError: It does not answer.
        AgentError: It speaks another protocol, or none.
    """
    try:
        spoken = host.connection.describe(timeout).protocol
    except grpc.RpcError as error:
        if error.code() is not grpc.StatusCode.UNIMPLEMENTED:
            raise
        raise AgentError(
            f"agent {name!r} does not offer Describe: {error.details()}",
            cause="agent_protocol",
            log=host.tail(),
        ) from error
    except AgentError as error:
        raise AgentError(
            f"agent {name!r}: {error}", cause="agent_protocol", log=host.tail()
        ) from error
    if spoken != VERSION:
        raise AgentError(
            f"agent {name!r} speaks version {spoken} of the protocol; allowed: {VERSION}. Build it "
            "with the agent.proto of this version of Drivora",
            cause="agent_protocol",
            log=host.tail(),
        )
