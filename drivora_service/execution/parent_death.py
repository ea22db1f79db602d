"""A worker must not outlive the process that owns it, however that one dies."""

from __future__ import annotations

import ctypes
import multiprocessing
import os
import platform
import signal
import threading
from multiprocessing.connection import wait

_PR_SET_PDEATHSIG = 1


def die_with_parent() -> None:
    """Arranges that this process is killed when the one that owns it dies, also by ``SIGKILL``.

    On Linux the kernel does it (``prctl(2)``), even if native code here never lets go of the
    interpreter; where a fork server lies between, that one ends with its owner and takes this
    process along. Elsewhere a thread waits for the end of the owner.
    """
    parent = multiprocessing.parent_process()
    if parent is None:
        return
    if platform.system() == "Linux":
        ctypes.CDLL(None, use_errno=True).prctl(_PR_SET_PDEATHSIG, int(signal.SIGKILL), 0, 0, 0)
        if wait([parent.sentinel], 0):
            os._exit(1)
        return

    def watch() -> None:
        wait([parent.sentinel])
        os._exit(1)

    threading.Thread(target=watch, name="parent-watch", daemon=True).start()
