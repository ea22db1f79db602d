"""What a command prints while its workers start, and while kernels are compiled."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import time
from itertools import pairwise
from pathlib import Path

import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.cli.terminal.start_progress import KERNELS_OF_A_START, StartLines
from drivora_service.compilation.compilation_progress import (
    VARIABLE,
    CompilationProgress,
    note_kernel,
    note_ready,
    read_compilation_progress,
)


def test_a_first_start_is_never_silent_for_three_seconds() -> None:
    lines = StartLines(is_first=True, now=0.0)
    printed_at = [0.0]
    for tenth in range(400):
        now = tenth / 10
        kernels = max(0, int(now) - 10)
        progress = CompilationProgress(kernels=kernels, ready=now >= 39.0)
        if lines.line(progress, now):
            printed_at.append(now)
    gaps = [after - before for before, after in pairwise(printed_at)]
    assert max(gaps) < 3.0
    assert len(printed_at) < 25


def test_a_start_without_compilation_prints_nothing() -> None:
    lines = StartLines(is_first=False, now=0.0)
    assert not any(
        lines.line(CompilationProgress(ready=second > 20), float(second)) for second in range(60)
    )


def test_kernels_that_are_compiled_again_are_announced_at_once() -> None:
    lines = StartLines(is_first=False, now=0.0)
    assert "1 of about" in lines.line(CompilationProgress(kernels=1), 0.4)
    assert not lines.line(CompilationProgress(kernels=2), 0.6)
    assert "after 1 s" in lines.line(CompilationProgress(kernels=2, ready=True), 1.0)


def test_progress_is_counted_in_a_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "progress"
    monkeypatch.setenv(VARIABLE, str(file))
    note_kernel()
    assert not file.exists()
    file.touch()
    note_kernel()
    note_kernel()
    assert read_compilation_progress(file) == CompilationProgress(kernels=2)
    note_ready()
    assert read_compilation_progress(file) == CompilationProgress(kernels=2, ready=True)


@pytest.mark.slow(seconds=60)
def test_a_first_run_on_a_machine_says_what_it_does(tmp_path: Path) -> None:
    """With an empty cache of kernels; the bound is generous, as other tests run beside it."""
    (tmp_path / "crossing.json").write_text(json.dumps(SCENARIO))
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "kernels")}
    lines, times = [], [time.monotonic()]
    with subprocess.Popen(
        [sys.executable, "-m", "drivora_service.cli", "run", "crossing.json", "--workers", "1"],
        cwd=tmp_path,
        env={**environment, "DRIVORA_DATA_DIR": str(tmp_path / "data")},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        assert process.stderr is not None
        for line in process.stderr:
            lines.append(line)
            times.append(time.monotonic())
    assert process.returncode == 0, lines
    gaps = [after - before for before, after in pairwise(times)]
    assert max(gaps) < 15.0, lines
    assert sum(gap > 4.0 for gap in gaps) <= len(gaps) // 4, gaps
    counts = [int(found) for found in re.findall(r": (\d+) of about", "".join(lines))]
    assert counts == sorted(counts)
    # The last line but one, which may stand before the last kernels.
    assert 0.85 * KERNELS_OF_A_START <= counts[-1] <= KERNELS_OF_A_START + 5
    assert "workers are ready" in lines[-1]
