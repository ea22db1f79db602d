"""Limits of the system with which nothing can be simulated."""

from __future__ import annotations

import errno
import json
import os
import resource
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.cli.terminal.process_limits import describe_shortage

_MEBIBYTE = 1 << 20


def ended(kind: int, value: int, *arguments: str | Path) -> tuple[int, str]:
    """Runs a command under a limit; returns its exit code and what it printed."""
    done = subprocess.run(
        [sys.executable, "-m", "drivora_service.cli", *arguments],
        preexec_fn=lambda: resource.setrlimit(kind, (value, value)),
        capture_output=True,
        text=True,
        check=False,
        timeout=100,
    )
    return done.returncode, done.stdout + done.stderr


@pytest.mark.parametrize("files", [10, 16, 32, 63])
def test_too_few_open_files_are_one_sentence(tmp_path: Path, files: int) -> None:
    scenario = tmp_path / "crossing.json"
    scenario.write_text(json.dumps(SCENARIO))
    for arguments in (("serve", "--port", "0"), ("run", scenario)):
        code, printed = ended(
            resource.RLIMIT_NOFILE, files, *arguments, "--data-dir", tmp_path / "data"
        )
        assert code == 2, printed
        assert f"only {files} files may be open at once" in printed
        assert len(printed.splitlines()) == 1
    assert not (tmp_path / "data" / "drivora.sqlite3").exists()


@pytest.mark.parametrize("mebibytes", [100, 1500])
def test_too_little_address_space_is_one_sentence(tmp_path: Path, mebibytes: int) -> None:
    code, printed = ended(
        resource.RLIMIT_AS,
        mebibytes * _MEBIBYTE,
        *("serve", "--port", "0", "--data-dir", tmp_path / "data"),
    )
    assert code == 2, printed
    assert f"only {mebibytes} MiB of address space" in printed
    assert len(printed.splitlines()) == 1


def test_too_few_processes_are_one_sentence(tmp_path: Path) -> None:
    if os.getuid() != 0 or shutil.which("setpriv") is None:
        pytest.skip("needs root and setpriv: the limit does not hold for root")
    tmp_path.chmod(0o777)
    rights = "+dac_override,+dac_read_search"
    command = ["setpriv", "--reuid=61234", "--clear-groups"]
    command += [f"--inh-caps={rights}", f"--ambient-caps={rights}", "prlimit", "--nproc=2:2"]
    command += [sys.executable, "-m", "drivora_service.cli", "serve", "--port", "0"]
    done = subprocess.run(
        [*command, "--data-dir", tmp_path / "data"],
        capture_output=True,
        text=True,
        check=False,
        timeout=100,
    )
    assert done.returncode == 3, done.stderr
    assert "processes -u" in done.stderr
    assert len(done.stderr.splitlines()) == 1


@pytest.mark.parametrize(
    "error",
    [
        OSError(errno.EMFILE, "Too many open files", "/some/file"),
        BlockingIOError(errno.EAGAIN, "Resource temporarily unavailable"),
        OSError(errno.ENOMEM, "Cannot allocate memory"),
        MemoryError(),
        RuntimeError("can't start new thread"),
    ],
)
def test_a_shortage_says_what_helps(error: BaseException) -> None:
    message = describe_shortage(error)
    assert "raise it" in message
    assert "\n" not in message


@pytest.mark.parametrize("error", [OSError(errno.EIO, "I/O error"), RuntimeError("other")])
def test_other_errors_are_no_shortage(error: BaseException) -> None:
    assert describe_shortage(error) == ""
