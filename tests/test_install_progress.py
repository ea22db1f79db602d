"""The progress of installations: what is printed while pip works."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

_SCRIPT = Path(__file__).parents[1] / "requirements" / "install.py"


@pytest.fixture(scope="module")
def script() -> ModuleType:
    spec = importlib.util.spec_from_file_location("install_script", _SCRIPT)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def run_script(*command: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, _SCRIPT, *command], capture_output=True, text=True, check=False, timeout=60
    )


PRINTED = """\
Collecting alembic==1.20.1 (from -r requirements/run.txt (line 1))
  Downloading alembic-1.20.1-py3-none-any.whl.metadata (7.2 kB)
  Downloading alembic-1.20.1-py3-none-any.whl (248 kB)
Collecting numpy==2.4.6 (from -r requirements/run.txt (line 40))
  Using cached numpy-2.4.6-cp311-cp311-manylinux_2_28_x86_64.whl (16.6 MB)
"""


def test_sizes_are_those_that_pip_prints(script: ModuleType) -> None:
    progress = script.Progress(3, 2)
    assert progress.state(2, 0.6) == "  looking for packages, 1 s"
    for line in PRINTED.splitlines():
        progress.read(line)
    assert progress.state(2, 5.0) == (
        "  fetching: 2 of 3 packages, 17 MB (0 MB downloaded), now numpy, 5 s"
    )
    progress.read("Installing collected packages: numpy, alembic, other")
    assert progress.state(4, 9.0) == "  unpacking 17 MB: 2 of 3 packages, 9 s"


def test_pinned_packages_are_those_of_this_system(script: ModuleType, tmp_path: Path) -> None:
    file = tmp_path / "pins.txt"
    file.write_text(
        "alembic==1.20.1 \\\n    --hash=sha256:00\ncolorama==0.4.6 ; sys_platform == 'win32' \\\n"
        "    --hash=sha256:00\nmoto[s3]==5.2.0\nrtamt==0.4.10 ; python_full_version < '3.13' \\\n"
    )
    assert script.pinned_packages(file) == 3


def test_a_long_command_is_not_silent() -> None:
    done = run_script(sys.executable, "-c", "import time; time.sleep(3.2)")
    assert done.stdout.startswith("  still at work, ")
    assert done.returncode == 0


def test_a_failure_prints_what_pip_said(tmp_path: Path) -> None:
    file = tmp_path / "pins.txt"
    file.write_text("no-such-package-of-drivora==1.0\n")
    pip = [sys.executable, "-m", "pip", "install", "--no-index", "--no-deps", "--target"]
    done = run_script(*pip, str(tmp_path / "site"), "-r", str(file))
    assert done.returncode == 1
    assert done.stdout.startswith(f"Installing 1 packages of {file}")
    assert "No matching distribution found for no-such-package-of-drivora" in done.stderr
    assert "ended with 1" in done.stderr
