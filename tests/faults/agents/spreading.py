"""Agents that use more than their process: children, memory of children, disk."""

from __future__ import annotations

import os
import subprocess
import sys
import time

from drivora_service.agents.interface import AccelerationControl, Observation
from tests.faults.agents.driving import Hostile, plugin

DAEMON_S = 98765
"""Seconds that a daemon sleeps; by this argument tests find it."""

CHILD_S = 98764
"""The same of a child of a hanging agent."""

FLOOD_BYTES = 256 << 20


class ChildHanger(Hostile):
    """Starts a child and hangs."""

    def harm(self) -> None:
        subprocess.Popen(["sleep", str(CHILD_S)])
        while True:
            time.sleep(60.0)


class Daemoniser(Hostile):
    """Starts a process that leaves its session and its parent, and drives on."""

    def harm(self) -> None:
        if (child := os.fork()) == 0:
            os.setsid()
            if os.fork() == 0:
                os.execvp("sleep", ["sleep", str(DAEMON_S)])
            os._exit(0)
        os.waitpid(child, 0)


class ChildEater(Hostile):
    """Starts a child that takes far more memory than a worker may, and drives on slowly."""

    def harm(self) -> None:
        code = "import time; a = [bytearray(b'x' * (1 << 27)) for _ in range(12)]; time.sleep(99)"
        subprocess.Popen([sys.executable, "-c", code])

    def run_step(self, observation: Observation) -> AccelerationControl:
        time.sleep(0.15)
        return super().run_step(observation)


class Flooder(Hostile):
    """Prints without end what no disk can hold, and drives on."""

    def harm(self) -> None:
        line = b"x" * 1023 + b"\n"
        for _ in range(FLOOD_BYTES // 1024):
            os.write(1, line)


child_hanger = plugin("child-hanger", ChildHanger)
daemoniser = plugin("daemoniser", Daemoniser)
child_eater = plugin("child-eater", ChildEater)
flooder = plugin("flooder", Flooder)
