"""A command loads what it uses: workers have the compiler, the process that searches does not."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO

UNUSED = ("libsumo", "llvmlite", "matplotlib", "numba", "pyarrow", "pymoo", "scipy", "sklearn")
"""Packages that neither reading a document nor most methods of search need."""

PROGRAM = f"""
import os, sys
from drivora_service.execution.local import LocalExecutor

def submit(self, spec):
    print("loaded:", *(name for name in {UNUSED} if name in sys.modules), flush=True)
    os._exit(0)

LocalExecutor.submit = submit
from drivora_service.cli.main import app
app(sys.argv[1:])
"""

CAMPAIGN = {
    "name": "crossing",
    "agent": {"name": "idm"},
    "scenario": SCENARIO,
    "space": {"vehicles": 2, "walkers": 1},
    "budget": {"simulations": 4},
    "seed": 3,
}


def loaded_at_the_first_run(folder: Path, *arguments: str) -> list[str]:
    """The packages that a command has loaded when it submits its first run."""
    output = folder / "output.txt"
    # A pipe would be open until the processes for workers, which are still starting, have ended.
    with output.open("w") as stream:
        subprocess.run(
            [sys.executable, "-c", PROGRAM, *arguments, "--data-dir", "data", "--workers", "1"],
            cwd=folder,
            stdout=stream,
            stderr=subprocess.STDOUT,
            timeout=180,
            check=False,
        )
    lines = output.read_text().splitlines()
    found = [line for line in lines if line.startswith("loaded:")]
    assert len(found) == 1, lines
    return found[0].split()[1:]


@pytest.mark.parametrize(
    "method",
    [
        "random",
        pytest.param("avfuzzer", marks=pytest.mark.slow(seconds=10)),
        pytest.param("behavexplor", marks=pytest.mark.slow(seconds=10)),
    ],
)
def test_a_campaign_begins_without_compiler(tmp_path: Path, method: str) -> None:
    file = tmp_path / "campaign.json"
    file.write_text(json.dumps({**CAMPAIGN, "tester": {"name": method}}))
    assert loaded_at_the_first_run(tmp_path, "campaign", "run", str(file)) == []


def test_a_study_begins_without_compiler(tmp_path: Path) -> None:
    (tmp_path / "crossing.json").write_text(json.dumps(SCENARIO))
    file = tmp_path / "study.json"
    study = {
        "name": "study",
        "scenarios": [{"file": "crossing.json"}],
        "agents": [{"name": "idm"}],
        "methods": [{"name": "random"}],
        "repetitions": 1,
        "budget": {"simulations": 4},
        "space": CAMPAIGN["space"],
    }
    file.write_text(json.dumps(study))
    assert loaded_at_the_first_run(tmp_path, "study", "run", str(file)) == []


def test_a_run_begins_without_compiler(tmp_path: Path) -> None:
    file = tmp_path / "crossing.json"
    file.write_text(json.dumps(SCENARIO))
    assert loaded_at_the_first_run(tmp_path, "run", str(file)) == []


def test_the_service_is_imported_without_compiler() -> None:
    program = f"import sys, drivora_service.app\nprint([n for n in {UNUSED} if n in sys.modules])"
    ended = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, timeout=120, check=True
    )
    assert ended.stdout.strip() == "[]"
