"""Every command of the README, the tutorial and the how-tos, run as it is written."""

from __future__ import annotations

import contextlib
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

import pytest

from tests.docs.blocks import Command, commands_of, installation_lines, missing_lines
from tests.docs.forked_drivora import forked_drivora
from tests.postgresql_server import PostgresqlServer

_ROOT = Path(__file__).resolve().parents[2]
_FILES = Path(__file__).with_name("files")
_TIME_LIMIT_S = 600.0
_SERVICE_PORT = "8000"
_PORTS = (_SERVICE_PORT, "6399")
"""Ports that the pages use, of a service and of a Ray cluster; the tests take free ones."""
PAGES = sorted(
    path.relative_to(_ROOT).as_posix()
    for path in (_ROOT / "README.md", *(_ROOT / "docs").glob("*/*.md"))
    if path.parent.name not in ("reference", "explanation", "decisions")
)
WITH_EXACT_NUMBERS = ("README.md", "docs/tutorial/first-run.md", "docs/tutorial/test-your-ads.md")
"""Pages whose numbers are results, and are compared digit by digit; ``…`` stands for others."""
STARTED_BY_A_SHELL = ("README.md", "docs/how-to/use-a-cluster.md")
"""Pages whose commands are started as users start them; those of others need fewer imports, see
`tests/docs/forked_drivora.py`. Between them, they run, search, serve, judge, draw and compare; a
service from the fork server would be ready before the head of its cluster."""
WITH_POSTGRESQL = "docs/how-to/use-postgresql.md"
"""A page whose commands need a server, and its tools."""
WITH_COMMANDS = [page for page in PAGES if commands_of((_ROOT / page).read_text())]


def test_tutorial_and_how_tos_have_commands() -> None:
    assert PAGES == WITH_COMMANDS


@pytest.mark.slow(seconds=30)
@pytest.mark.parametrize("page", WITH_COMMANDS)
def test_commands_work_as_they_are_written(
    page: str, tmp_path: Path, request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch
) -> None:
    if page == WITH_POSTGRESQL:
        server: PostgresqlServer = request.getfixturevalue("postgresql")
        monkeypatch.setenv("PGHOST", str(server.folder))
        monkeypatch.setenv("PGUSER", "postgres")
        monkeypatch.setenv("PATH", f"{server.programs}{os.pathsep}{os.environ['PATH']}")
    commands = commands_of((_ROOT / page).read_text())
    assert commands
    exact = page in WITH_EXACT_NUMBERS
    with contextlib.ExitStack() as stack:
        programs = () if page in STARTED_BY_A_SHELL else (stack.enter_context(forked_drivora()),)
        ended = list(run_page(commands, tmp_path, programs=programs))
    for command, (code, printed) in zip(commands, ended, strict=True):
        assert (code != 0) == command.fails, f"$ {command.script}\n{printed}"
        missing = missing_lines(command.expected, printed, exact=exact)
        assert not missing, f"{missing}\n$ {command.script}\n{printed}"


def run_page(
    commands: Sequence[Command], tmp_path: Path, *, programs: Sequence[Path] = ()
) -> Iterator[tuple[int, str]]:
    """Runs the commands of a page in a folder of their own; yields exit codes and outputs.

    Args:
        commands: The commands.
        tmp_path: The folder is made in it.
        programs: Folders whose programs come before all others.
    """
    folder = tmp_path / "checkout"
    shutil.copytree(_FILES, folder)
    for name in ("openscenario_schemas", "sumo_nets", "deploy"):
        (folder / name).symlink_to(_ROOT / name)
    ports = {written: str(_free_port()) for written in _PORTS}
    script = ["trap 'kill $(jobs -p) 2>/dev/null' EXIT"]
    for number, command in enumerate(commands):
        text = command.script
        for written, port in ports.items():
            text = re.sub(rf"\b{written}\b", port, text)
        script.append(f"{{\n{text}\n}} >> {tmp_path}/{number}.out 2>&1")
        script.append(f"echo $? > {tmp_path}/{number}.code")
    _run("\n".join(script), folder, ports[_SERVICE_PORT], programs)
    for number in range(len(commands)):
        printed = (tmp_path / f"{number}.out").read_text()
        for written, port in ports.items():
            printed = printed.replace(port, written)
        yield int((tmp_path / f"{number}.code").read_text()), printed


@pytest.mark.parametrize("page", PAGES)
def test_installation_names_targets_that_exist(page: str) -> None:
    targets = set(re.findall(r"^([a-z-]+):", (_ROOT / "Makefile").read_text(), re.MULTILINE))
    named = {
        line.split("#")[0].split()[1]
        for line in installation_lines((_ROOT / page).read_text())
        if line.startswith("make ")
    }
    assert named <= targets


def _run(script: str, folder: Path, port: str, programs: Sequence[Path]) -> None:
    """Runs a script, and ends with it all that it started."""
    site = folder.parent / "site"
    environment = {
        **os.environ,
        "PATH": os.pathsep.join(
            [*map(str, programs), str(Path(sys.executable).parent), os.environ["PATH"]]
        ),
        "DRIVORA_PORT": port,
        "COLUMNS": "80",
        # Packages that a page installs must not reach the environment of the tests.
        "PIP_TARGET": str(site),
        "PYTHONPATH": f"{site}{os.pathsep}{_ROOT}",
    }
    process = subprocess.Popen(
        ["bash", "-c", script], cwd=folder, env=environment, start_new_session=True
    )
    try:
        process.wait(_TIME_LIMIT_S)
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
    return port
