"""``python -m drivora_service.cli``."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

INTERRUPTED_WHILE_A_CLASS_IS_MADE = """
import runpy, sys
from drivora_service.cli.exit_codes import ExitCode
from drivora_service.cli.main import app

def command():
    try:
        exec("raise KeyboardInterrupt")
    except KeyboardInterrupt:
        raise SystemExit(int(ExitCode.NOT_DONE))

app.registered_commands.clear()
app.registered_groups.clear()
app.command("run")(command)
runpy.run_module("drivora_service.cli", run_name="__main__")
"""


def test_a_handled_interrupt_leaves_the_exit_code(tmp_path: Path) -> None:
    (tmp_path / "interrupted.py").write_text(INTERRUPTED_WHILE_A_CLASS_IS_MADE)
    done = subprocess.run([sys.executable, "-m", "interrupted", "run"], cwd=tmp_path, timeout=60)
    assert done.returncode == 3
