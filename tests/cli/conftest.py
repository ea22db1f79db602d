"""The command line, run as users run it: a process of its own."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from drivora_service.api.examples import SCENARIO


@dataclass(frozen=True, slots=True)
class Ended:
    """A command that has ended."""

    code: int
    out: str
    err: str

    def json(self) -> Any:
        """What it printed, as JSON."""
        return json.loads(self.out)


Drivora = Callable[..., Ended]


@pytest.fixture
def drivora(tmp_path: Path) -> Drivora:
    """Runs ``drivora`` with a data folder of the test's own."""

    def run(*arguments: str | Path, **environment: str) -> Ended:
        command = [sys.executable, "-m", "drivora_service.cli", *map(str, arguments)]
        ended = subprocess.run(
            command,
            capture_output=True,
            text=True,
            cwd=tmp_path,
            timeout=120,
            check=False,
            env={**os.environ, "DRIVORA_DATA_DIR": str(tmp_path / "data"), **environment},
        )
        return Ended(ended.returncode, ended.stdout, ended.stderr)

    return run


@pytest.fixture
def scenario_file(tmp_path: Path) -> Path:
    """A scenario that can be run."""
    path = tmp_path / "crossing.json"
    path.write_text(json.dumps(SCENARIO))
    return path
