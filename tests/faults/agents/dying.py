"""Agents that end their process, stop it, or keep it busy."""

from __future__ import annotations

import ctypes
import os
import signal
import time

from tests.faults.agents.driving import Hostile, plugin


class Hanger(Hostile):
    """Sleeps for ever."""

    def harm(self) -> None:
        while True:
            time.sleep(60.0)


class Burner(Hostile):
    """Computes for ever."""

    def harm(self) -> None:
        while True:
            pass


class Segfault(Hostile):
    """Reads at address 0."""

    def harm(self) -> None:
        ctypes.string_at(0)


class Exiter(Hostile):
    """Ends the process past every handler."""

    def harm(self) -> None:
        os._exit(3)


class SelfKiller(Hostile):
    """Kills its own process."""

    def harm(self) -> None:
        os.kill(os.getpid(), signal.SIGKILL)


class SelfStopper(Hostile):
    """Stops its own process."""

    def harm(self) -> None:
        os.kill(os.getpid(), signal.SIGSTOP)


hanger = plugin("hanger", Hanger)
burner = plugin("burner", Burner)
segfault = plugin("segfault", Segfault)
exiter = plugin("exiter", Exiter)
self_killer = plugin("self-killer", SelfKiller)
self_stopper = plugin("self-stopper", SelfStopper)
