"""The demo at a terminal."""

from __future__ import annotations

import os
import pty
import re
import select
import signal
import subprocess
import sys
import time
from pathlib import Path

import httpx
import pytest

_PAGE = re.compile(r"The page, until Ctrl-C ends the service:\s+(http://\S+)")


@pytest.mark.slow
def test_at_a_terminal_the_page_stays_until_ctrl_c(tmp_path: Path) -> None:
    screen, terminal = pty.openpty()
    command = [sys.executable, "-m", "drivora_service.cli", "demo", "--num", "2"]
    process = subprocess.Popen(
        [*command, "--simulations", "10", "--workers", "1"],
        stdin=terminal,
        stdout=terminal,
        stderr=terminal,
        cwd=tmp_path,
        start_new_session=True,
    )
    os.close(terminal)
    try:
        address = httpx.URL(_read_until(screen, _PAGE, within_s=300.0))
        page = httpx.get(address)
        assert page.status_code == 200
        assert page.headers["content-type"].startswith("text/html")
        shown = httpx.get(address.join(f"/api/v1{address.path}")).json()
        assert shown["state"] == "finished"
        assert process.poll() is None
        process.send_signal(signal.SIGINT)
        assert process.wait(60) == 0
    finally:
        process.kill()
        process.wait()
        os.close(screen)
    with pytest.raises(httpx.ConnectError):
        httpx.get(address)


def _read_until(screen: int, wanted: re.Pattern[str], *, within_s: float) -> str:
    """Reads what a terminal shows until a pattern is found; returns the pattern's group."""
    shown = ""
    deadline = time.monotonic() + within_s
    while time.monotonic() < deadline:
        if select.select([screen], [], [], 1.0)[0]:
            try:
                shown += os.read(screen, 65536).decode(errors="replace")
            except OSError:
                break  # The process has ended, and with it the terminal.
        if found := wanted.search(shown):
            return found[1]
    raise AssertionError(f"{wanted.pattern} was not shown, but:\n{shown}")
