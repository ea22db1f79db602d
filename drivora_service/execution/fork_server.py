"""The process that starts our other processes, with the imports done that they need."""

from __future__ import annotations

import multiprocessing
from multiprocessing.context import ForkServerContext

_PRELOADED = "drivora_service.execution.preloaded"


def fork_server(*, preloaded: bool = True) -> ForkServerContext:
    """Gives the way to start processes; a process has one fork server, started with its first.

    Args:
        preloaded: Whether it shall import what workers need, which takes a second or two; heeded
            until the fork server is started.
    """
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["__main__", *([_PRELOADED] if preloaded else [])])
    return context
