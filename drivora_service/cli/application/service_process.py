"""A service in a process of its own, for as long as a command needs it."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from drivora_service.api.guards.api_tokens import Scope, TokenFile
from drivora_service.cli.application.installation import settings_for
from drivora_service.client import Client
from drivora_service.errors import ServiceError, ServiceUnavailable, UnknownName

_START_S = 180.0
"""A fresh installation compiles first, which takes a busy machine more than a minute."""
_STOP_S = 20.0
_POLL_S = 0.05
_OWN_SETTINGS = {
    # A command has no use for runs that it has not waited for.
    "DRIVORA_DRAIN_S": "0",
    # No proxy leads to it, whatever leads to the service of this environment.
    "DRIVORA_PUBLIC_URL": "",
    "DRIVORA_ROOT_PATH": "",
}
_OWN_TOKEN = "drivora demo"
"""Name of the token of a command."""


@contextmanager
def run_service(
    data_dir: Path, *, workers: int, meanwhile: Callable[[], None] = lambda: None
) -> Iterator[str]:
    """Starts a service on a free port of loopback and yields its address; ends it afterwards.

    Its log is ``service.log`` in the data folder.

    Args:
        data_dir: Data folder of the service.
        workers: Number of worker processes.
        meanwhile: Called while the service starts, before this function waits for it.

    Raises:
        ServiceError: It does not start, or cannot start workers.
    """
    data_dir.mkdir(mode=0o700, parents=True, exist_ok=True)
    announcement = data_dir / "service.json"
    announcement.unlink(missing_ok=True)
    command = [sys.executable, "-m", "drivora_service.cli", "serve"]
    options = ["--data-dir", str(data_dir), "--workers", str(workers), "--host", "127.0.0.1"]
    with open(data_dir / "service.log", "ab", opener=_open_private) as log:
        process = subprocess.Popen(
            [*command, *options, "--port", "0"],
            stdout=log,
            stderr=log,
            env={**os.environ, **_OWN_SETTINGS},
        )
    try:
        meanwhile()
        yield _wait_until_ready(process, announcement)
    finally:
        process.send_signal(signal.SIGINT)
        try:
            process.wait(_STOP_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


@contextmanager
def own_token(data_dir: Path) -> Iterator[str | None]:
    """Yields a token of its own for a command, for as long as the command needs it.

    It is ``None`` where the service of a data folder needs no token.

    Raises:
        CredentialsUnusable: The tokens of the data folder cannot be read.
        StoreError: They cannot be written.
    """
    settings = settings_for(data_dir)
    tokens = TokenFile(settings.tokens_path, always_needed=settings.require_tokens)
    if not tokens.are_needed:
        yield None
        return
    # One that a killed command has left; its secret is lost.
    with contextlib.suppress(UnknownName):
        tokens.revoke(_OWN_TOKEN)
    try:
        yield tokens.create(_OWN_TOKEN, Scope.ADMIN)
    finally:
        with contextlib.suppress(UnknownName):
            tokens.revoke(_OWN_TOKEN)


def _open_private(path: str, flags: int) -> int:
    return os.open(path, flags, 0o600)


def _wait_until_ready(process: subprocess.Popen[bytes], announcement: Path) -> str:
    deadline = time.monotonic() + _START_S
    while time.monotonic() < deadline:
        if process.poll() is not None:
            raise ServiceError(
                f"the service ended with code {process.returncode}; "
                f"{announcement.with_name('service.log')} says why"
            )
        if announcement.is_file():
            url: str = json.loads(announcement.read_text())["url"]
            with contextlib.suppress(ServiceUnavailable), Client(url, retry_s=0.0) as client:
                readiness = client.readiness()
                if readiness.ready:
                    return url
                for check in readiness.checks:
                    if check.name == "workers" and not check.ok:
                        raise ServiceError(check.detail)
        time.sleep(_POLL_S)
    raise ServiceError(f"the service was not ready within {_START_S:g} s")
