"""The command line, run as users run it: a process of its own.

The processes come from the fork server of the tests, which has imported the package: a suite of
commands would else spend its time on imports. The pages of the documentation test commands as a
shell starts them.
"""

from __future__ import annotations

import importlib
import itertools
import json
import os
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from tests.command_process import begin

_TIME_LIMIT_S = 120.0


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
def drivora(tmp_path: Path, tmp_path_factory: pytest.TempPathFactory) -> Drivora:
    """Runs ``drivora`` with a data folder of the test's own."""
    numbers = itertools.count()
    printed = tmp_path_factory.mktemp("printed")

    def run(*arguments: str | Path, **environment: str) -> Ended:
        number = next(numbers)
        out, err = printed / f"{number}.out", printed / f"{number}.err"
        variables = {**os.environ, "DRIVORA_DATA_DIR": str(tmp_path / "data"), **environment}
        begun = begin(*arguments, folder=tmp_path, environment=variables, out=out, err=err)
        try:
            code = begun.wait(_TIME_LIMIT_S)
        except TimeoutError:
            begun.kill()
            raise AssertionError(f"drivora {arguments} did not end: {err.read_text()}") from None
        return Ended(code, out.read_text(), err.read_text())

    return run


@pytest.fixture
def scenario_file(tmp_path: Path) -> Path:
    """A scenario that can be run."""
    path = tmp_path / "crossing.json"
    path.write_text(json.dumps(SCENARIO))
    return path


def install_agents(site: Path, *, version: str) -> None:
    """Makes the unsteady agents a distribution of a version that Python finds on its path."""
    shutil.rmtree(site, ignore_errors=True)
    info = site / f"unsteady_agents-{version}.dist-info"
    info.mkdir(parents=True)
    shutil.copy(Path(__file__).with_name("unsteady_agents.py"), site)
    (info / "METADATA").write_text(
        f"Metadata-Version: 2.1\nName: unsteady-agents\nVersion: {version}\n"
    )
    names = ("dicing", "failing", "remembering")
    lines = [f"{name} = unsteady_agents:{name}" for name in names]
    (info / "entry_points.txt").write_text("\n".join(["[drivora_service.agents]", *lines, ""]))
    importlib.invalidate_caches()


@pytest.fixture
def site(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of the installed unsteady agents."""
    folder = tmp_path / "site"
    install_agents(folder, version="1.0")
    monkeypatch.syspath_prepend(str(folder))
    return folder
