"""Agents that turn against the service from within their worker."""

from __future__ import annotations

import os
import pickle
import signal
import struct
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from drivora_service.agents.entry import AgentEntry, AgentKind
from drivora_service.agents.idm.agent import IdmAgent
from drivora_service.agents.interface import AccelerationControl, Observation
from drivora_service.agents.plugin import AgentPlugin

NOTES = Path(os.environ.get("HOSTILE_NOTES", "."))
AFTER_S = 1.0


class _Command:
    """Has a file made where it is unpickled."""

    def __reduce__(self) -> tuple[object, ...]:
        return os.mknod, (str(NOTES / "commanded"),)


def _sockets() -> list[int]:
    found = []
    for file in Path("/proc/self/fd").iterdir():
        try:
            if str(file.readlink()).startswith("socket:"):
                found.append(int(file.name))
        except OSError:
            continue
    return found


class Hostile(IdmAgent):
    """Drives for a second and turns then."""

    def run_step(self, observation: Observation) -> AccelerationControl:
        if observation.time > AFTER_S:
            self.turn()
        return super().run_step(observation)

    def turn(self) -> None:
        raise NotImplementedError


class Commander(Hostile):
    """Writes a pickle to every socket that it finds."""

    def turn(self) -> None:
        body = pickle.dumps(_Command())
        for socket in _sockets():
            os.write(socket, struct.pack("!i", len(body)) + body)
        time.sleep(60)


class Promiser(Hostile):
    """Promises four gigabytes to every socket that it finds."""

    def turn(self) -> None:
        for socket in _sockets():
            os.write(socket, struct.pack("!4sII", b"drvr", 4, 2**32 - 1))
        time.sleep(60)


class Daemonizer(Hostile):
    """Starts a process that leaves the session, once."""

    def turn(self) -> None:
        note = NOTES / "daemon"
        if note.exists():
            return
        if os.fork() == 0:
            os.setsid()
            if os.fork() == 0:
                note.write_text(str(os.getpid()))
                time.sleep(3600)
            os._exit(0)
        os.wait()
        while not note.exists():
            time.sleep(0.01)


class Killer(Hostile):
    """Kills the process that started its own."""

    def turn(self) -> None:
        os.kill(os.getppid(), signal.SIGKILL)
        time.sleep(60)


class Spawner(Hostile):
    """Starts a child and hangs."""

    def turn(self) -> None:
        if os.fork() == 0:
            time.sleep(3600)
        time.sleep(3600)


def _plugin(name: str, kind: type[IdmAgent]) -> AgentPlugin:
    def create(parameters: Mapping[str, Any]) -> IdmAgent:
        return kind()

    entry = AgentEntry(
        name=name,
        kind=AgentKind.MODULE_BASED,
        description=kind.__doc__ or "",
        source="the tests",
        licence="Apache-2.0",
    )
    return AgentPlugin(entry=entry, create=create)


commander = _plugin("commander", Commander)
promiser = _plugin("promiser", Promiser)
daemonizer = _plugin("daemonizer", Daemonizer)
killer = _plugin("killer", Killer)
spawner = _plugin("spawner", Spawner)
