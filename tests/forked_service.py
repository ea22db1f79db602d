"""A real service from the fork server of the tests, which has the imports of it and its workers.

One that a shell starts spends some seconds on imports before it is ready, twice: its own, and those
of its fork server. That start is tested where it is the point, and by the commands of the
documentation.
"""

from __future__ import annotations

import contextlib
import json
import os
import signal
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import httpx

from tests.command_process import Begun, begin

_START_S = 180.0
_STOP_S = 20.0


@contextmanager
def forked_service(data_dir: Path, *options: str, workers: int) -> Iterator[str]:
    """Yields the address of a service on a free port, which is interrupted at the end."""
    begun = begin_service(data_dir, *options, workers=workers)
    try:
        yield wait_until_ready(begun, data_dir)
    finally:
        if begun.poll() is None:
            begun.send_signal(signal.SIGINT)
        try:
            begun.wait(_STOP_S)
        except TimeoutError:
            begun.kill()


@contextmanager
def killed_service(data_dir: Path, *, port: int = 0) -> Iterator[tuple[Begun, str]]:
    """Yields a service with two workers, and its address; it is killed at the end."""
    begun = begin_service(data_dir, workers=2, port=port)
    try:
        yield begun, wait_until_ready(begun, data_dir)
    finally:
        begun.kill()


def begin_service(data_dir: Path, *options: str, workers: int, port: int = 0) -> Begun:
    """Begins a service, and does not wait until it is ready."""
    data_dir.mkdir(mode=0o700, parents=True, exist_ok=True)
    _announcement(data_dir).unlink(missing_ok=True)
    log = data_dir / "service.log"
    usual: tuple[str | Path, ...] = (
        "--data-dir",
        data_dir,
        "--workers",
        str(workers),
        "--host",
        "127.0.0.1",
    )
    return begin(
        *("serve", *usual, *options, "--port", str(port)),
        folder=data_dir,
        environment={**os.environ, "DRIVORA_DRAIN_S": "0"},
        out=log,
        err=log,
    )


def wait_until_ready(begun: Begun, data_dir: Path) -> str:
    """Waits until a service is ready, and returns its address."""
    deadline = time.monotonic() + _START_S
    while begun.poll() is None and time.monotonic() < deadline:
        with contextlib.suppress(OSError, ValueError, httpx.HTTPError):
            url: str = json.loads(_announcement(data_dir).read_text())["url"]
            if httpx.get(f"{url}/readyz", verify=False).is_success:
                return url
        time.sleep(0.05)
    raise AssertionError((data_dir / "service.log").read_text())


def _announcement(data_dir: Path) -> Path:
    return data_dir / "service.json"
