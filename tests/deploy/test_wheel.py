"""The wheel is the whole product: installed into an empty environment, used without a checkout.

Its demo runs at a terminal, where the page stays until Ctrl-C; elsewhere it ends by itself
(`tests/cli/test_commands.py`). A shell starts services of a wheel in `test_ci_templates.py`.
"""

from __future__ import annotations

import json
import os
import pty
import re
import select
import signal
import subprocess
import sys
import time
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import httpx
import pytest

from tests.deploy.machine_code import copy_machine_code

_TIME_LIMIT_S = 600.0
_PAGE = re.compile(r"The page, until Ctrl-C ends the service:\s+(http://\S+)")
_KEPT = ("LANG", "LD_LIBRARY_PATH", "PATH", "SSL_CERT_FILE", "UV_CACHE_DIR", "UV_INDEX_URL")


@dataclass(frozen=True)
class Installation:
    """An environment with the wheel in it, and an empty folder to work in."""

    environment: Path
    folder: Path
    variables: Mapping[str, str]

    @property
    def drivora(self) -> str:
        """The command."""
        return str(self.environment / "bin" / "drivora")

    def run(self, *arguments: str) -> str:
        """Runs a command of Drivora and returns what it printed."""
        done = subprocess.run(
            [self.drivora, *arguments],
            cwd=self.folder,
            env=self.variables,
            capture_output=True,
            text=True,
            timeout=_TIME_LIMIT_S,
            check=False,
        )
        assert done.returncode == 0, f"{arguments}\n{done.stdout}\n{done.stderr}"
        return done.stdout

    @contextmanager
    def demo_at_a_terminal(self, *options: str) -> Iterator[tuple[str, httpx.URL]]:
        """Runs the demo until it shows the address of its page; interrupts it at the end.

        Yields what it has shown until then, and the address.
        """
        screen, terminal = pty.openpty()
        process = subprocess.Popen(
            [self.drivora, "demo", *options],
            stdin=terminal,
            stdout=terminal,
            stderr=terminal,
            cwd=self.folder,
            env=self.variables,
            start_new_session=True,
        )
        os.close(terminal)
        try:
            shown, page = _read_until(screen, _PAGE, within_s=_TIME_LIMIT_S)
            yield shown, httpx.URL(page)
            assert process.poll() is None
            process.send_signal(signal.SIGINT)
            assert process.wait(_TIME_LIMIT_S) == 0
        finally:
            process.kill()
            process.wait()
            os.close(screen)


@pytest.fixture(scope="module")
def installation(
    wheel: Path, repository: Path, tmp_path_factory: pytest.TempPathFactory
) -> Installation:
    """What the metadata of the wheel asks for, in the pinned versions, from the registry."""
    root = tmp_path_factory.mktemp("user")
    environment, folder, home = root / "environment", root / "work", root / "home"
    folder.mkdir()
    home.mkdir()
    uv = [sys.executable, "-m", "uv"]
    subprocess.run([*uv, "venv", "--quiet", "--python", sys.executable, environment], check=True)
    pinned = repository / "requirements" / "image.txt"
    subprocess.run(
        [
            *(*uv, "pip", "install", "--quiet"),
            *("--python", str(environment / "bin" / "python"), "--constraints", str(pinned)),
            f"drivora[postgresql] @ {wheel.as_uri()}",
        ],
        check=True,
        cwd=folder,
    )
    (packages,) = environment.glob("lib/python*/site-packages")
    # To compile the same once more would take a minute.
    copy_machine_code(repository / "drivora_service", packages / "drivora_service")
    variables = {name: os.environ[name] for name in _KEPT if name in os.environ}
    paths = variables["PATH"].split(os.pathsep)
    variables["PATH"] = os.pathsep.join(path for path in paths if ".venv" not in path)
    return Installation(environment, folder, {**variables, "HOME": str(home)})


@pytest.mark.slow(seconds=10)
def test_the_wheel_has_all_data(wheel: Path, repository: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        names = set(archive.namelist())
    shipped = {
        f"drivora_service/_data/{path.relative_to(repository).as_posix()}"
        for folder in ("sumo_nets", "openscenario_schemas")
        for path in (repository / folder).rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    assert shipped <= names
    assert "drivora_service/dashboard/built/index.html" in names
    assert not [name for name in names if name.startswith(("tests/", "benchmarks/"))]
    assert not [name for name in names if name.startswith("drivora_service/dashboard/web/")]


@pytest.mark.slow(seconds=60)
def test_a_user_needs_no_checkout(installation: Installation, repository: Path) -> None:
    assert re.fullmatch(r"\d+\.\d+\.\d+\n", installation.run("--version"))
    # Nothing is found in the checkout, not even by accident.
    where = subprocess.run(
        [installation.environment / "bin" / "python", "-c", "import drivora_service as d;"
         "print(d.__path__[0])"],
        capture_output=True, text=True, check=True, cwd=installation.folder,
        env=installation.variables,
    ).stdout  # fmt: skip
    assert not Path(where.strip()).is_relative_to(repository)

    installation.run("examples", "--out", "examples")
    printed = installation.run(
        "run", "examples/walker-behind-van.json", "--out", "results", "--json"
    )
    run = json.loads(printed)
    assert run["status"] == "finished"
    assert run["verdicts"]
    assert (installation.folder / "results" / "walker-behind-van.trace.parquet").is_file()
    assert "smoke" in installation.run("suite", "list", "smoke")

    options = ("--num", "2", "--simulations", "8", "--workers", "1")
    with installation.demo_at_a_terminal(*options) as (shown, address):
        assert "2 of 2 runs judged" in shown
        page = httpx.get(address)
        assert page.status_code == 200
        assert page.headers["content-type"].startswith("text/html")
        assert "<title>Drivora" in page.text
        parts = re.findall(r'(?:src|href)="(/[^"]+\.(?:js|css))"', page.text)
        assert parts
        for part in parts:
            assert httpx.get(address.join(part)).is_success
        campaign = httpx.get(address.join(f"/api/v1{address.path}")).json()
        assert campaign["state"] == "finished"
        listed = httpx.get(address.join("/api/v1/networks")).json()["items"]
        assert {"tee-town", "grid-district"} & {one["name"] for one in listed}
    with pytest.raises(httpx.ConnectError):
        httpx.get(address)


def _read_until(screen: int, wanted: re.Pattern[str], *, within_s: float) -> tuple[str, str]:
    """Reads a terminal until it shows a pattern; returns all that it showed, and the group."""
    shown = ""
    deadline = time.monotonic() + within_s
    while time.monotonic() < deadline:
        if select.select([screen], [], [], 1.0)[0]:
            try:
                shown += os.read(screen, 65536).decode(errors="replace")
            except OSError:
                break  # The process has ended, and with it the terminal.
        if found := wanted.search(shown):
            return shown, found[1]
    raise AssertionError(f"{wanted.pattern} was not shown, but:\n{shown}")
