"""The program that stands for `drivora` in the scripts of pages."""

from __future__ import annotations

import os
import subprocess
from importlib.metadata import version
from pathlib import Path

import pytest

from tests.docs.forked_drivora import forked_drivora


@pytest.fixture
def environment(monkeypatch: pytest.MonkeyPatch) -> dict[str, str]:
    monkeypatch.delenv("DRIVORA_WORKERS", raising=False)
    return dict(os.environ)


def test_a_shell_gets_outputs_and_exit_codes(environment: dict[str, str], tmp_path: Path) -> None:
    script = "echo before; drivora --version; drivora nothing 2> error; echo $?; drivora --version"
    with forked_drivora() as programs:
        environment["PATH"] = f"{programs}{os.pathsep}{environment['PATH']}"
        done = subprocess.run(
            ["bash", "-c", f"{{ {script} | cat; }} >> out"], cwd=tmp_path, env=environment
        )
    assert done.returncode == 0
    number = version("drivora")
    assert (tmp_path / "out").read_text() == f"before\n{number}\n2\n{number}\n"
    assert "nothing" in (tmp_path / "error").read_text()


def test_settings_of_the_shell_are_those_of_the_command(
    environment: dict[str, str], tmp_path: Path
) -> None:
    script = "DRIVORA_WORKERS=many drivora networks list; exit $?"
    with forked_drivora() as programs:
        environment["PATH"] = f"{programs}{os.pathsep}{environment['PATH']}"
        done = subprocess.run(
            ["bash", "-c", script], cwd=tmp_path, env=environment, capture_output=True, text=True
        )
    assert done.returncode == 2
    assert "DRIVORA_WORKERS" in done.stderr


@pytest.mark.parametrize("signal", ["TERM", "KILL"])
def test_a_command_ends_with_its_program(
    environment: dict[str, str], tmp_path: Path, signal: str
) -> None:
    """A service goes in good order where it is asked to, and at once where it cannot be."""
    script = f"""
    drivora serve --workers 1 --port 0 --data-dir data > log 2>&1 &
    until [ -f data/service.json ]; do sleep 0.05; done
    kill -{signal} $!
    wait $!
    echo $? > code
    """
    with forked_drivora() as programs:
        environment["PATH"] = f"{programs}{os.pathsep}{environment['PATH']}"
        subprocess.run(["bash", "-c", script], cwd=tmp_path, env=environment, check=True)
    # Here all commands have ended.
    assert int((tmp_path / "code").read_text()) == (0 if signal == "TERM" else 128 + 9)
    assert (tmp_path / "data" / "service.json").exists() == (signal == "KILL")
