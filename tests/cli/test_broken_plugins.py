"""A plug-in that cannot be loaded: its file and line, and with -v its traceback."""

from __future__ import annotations

import errno
import os
from pathlib import Path

import pytest

from drivora_service.cli.terminal.file_errors import describe_file_error
from tests.cli.conftest import Drivora


@pytest.fixture
def broken(tmp_path: Path) -> Path:
    """The module of an installed agent that cannot be imported."""
    site = tmp_path / "site"
    info = site / "broken_plugins-1.0.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: broken-plugins\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(
        "[drivora_service.agents]\nbroken = agent_without_its_library:agent\n"
    )
    module = site / "agent_without_its_library.py"
    module.write_text('"""An ADS."""\n\nimport no_such_library\n\nagent = no_such_library.agent\n')
    return module


def test_the_line_of_a_broken_plugin_and_its_traceback(drivora: Drivora, broken: Path) -> None:
    site = str(broken.parent)
    brief = drivora("agents", "show", "broken", PYTHONPATH=site)
    place = f"No module named 'no_such_library' ({broken}, line 3)"
    assert place in brief.out
    assert "Traceback" not in brief.out + brief.err
    whole = drivora("agents", "show", "broken", "-v", PYTHONPATH=site)
    assert place in whole.out
    assert "Traceback (most recent call last)" in whole.err
    assert f'File "{broken}", line 3' in whole.err


def test_an_error_has_a_traceback_with_v_only(drivora: Drivora) -> None:
    brief, whole = drivora("agents", "show", "idmm"), drivora("-v", "agents", "show", "idmm")
    assert brief.code == whole.code == 2
    assert brief.err.startswith("unknown agent 'idmm'; did you mean 'idm'? Known: ")
    assert "Traceback" not in brief.err
    assert "Traceback" in whole.err


@pytest.mark.parametrize(
    ("number", "file", "message"),
    [
        (errno.EROFS, "out/run.svg", "out/run.svg cannot be used: Read-only file system; name an"),
        (errno.ENOSPC, None, "a file cannot be written: No space left on device; free space"),
        (errno.ECONNRESET, None, ""),
    ],
)
def test_a_file_that_cannot_be_used_is_named(number: int, file: str | None, message: str) -> None:
    error = OSError(number, os.strerror(number), file)
    assert describe_file_error(error).startswith(message)
    assert bool(describe_file_error(error)) == bool(message)
