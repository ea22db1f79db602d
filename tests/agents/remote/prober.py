"""An ADS that tries what it must not be able to do, and logs what came of it as JSON."""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from drivora_service.agents.interface import AccelerationControl, Observation
from drivora_service.agents.remote import serving
from drivora_service.agents.remote.views import ContextView


def attempt(what: Callable[[], Any]) -> str:
    """Returns "done", or the error."""
    try:
        what()
    except OSError as error:
        return type(error).__name__
    return "done"


def eat() -> None:
    kept = []
    while True:
        kept.append(np.ones(2**20))


class Prober:
    """Its parameters are what to try: ``secret`` to read, ``service`` to signal, ``eat``."""

    def setup_env(self, context: ContextView) -> None:
        given = context.parameters
        if given.get("eat"):
            eat()
        scratch = Path(os.environ["TMPDIR"])
        status = Path("/proc/self/status").read_text()
        secret, service = Path(given["secret"]), int(given["service"])
        found = {
            "user": os.getuid(),
            "groups": os.getgroups(),
            "read": attempt(secret.read_bytes),
            "list": attempt(lambda: list(secret.parent.iterdir())),
            "write": attempt(lambda: (secret.parent / "planted").write_text("x")),
            "write_own_code": attempt(lambda: Path(__file__).write_text("")),
            "signal": attempt(lambda: os.kill(service, 0)),
            "environment": attempt(Path(f"/proc/{service}/environ").read_bytes),
            "scratch": attempt(lambda: (scratch / "mine").write_text("x")),
            "variables": dict(os.environ),
            "no_new_privileges": "NoNewPrivs:\t1" in status,
            "core": resource.getrlimit(resource.RLIMIT_CORE),
            "files": resource.getrlimit(resource.RLIMIT_NOFILE),
            "processes": resource.getrlimit(resource.RLIMIT_NPROC),
            "big_file": attempt(lambda: big_file(scratch)),
            "child": subprocess.run(
                [sys.executable, "-c", "import os; print(os.getuid())"],
                capture_output=True,
                text=True,
                check=True,
            ).stdout.strip(),
        }
        context.log.event(json.dumps(found))

    def run_step(self, observation: Observation) -> AccelerationControl:
        return AccelerationControl(1.0, 0.0)


def big_file(scratch: Path) -> None:
    """Writes a file of ten mebibytes; Python ignores the signal that comes with the error."""
    (scratch / "big").write_bytes(bytes(10 << 20))


if __name__ == "__main__":
    serving.serve(Prober)
