"""The progress of a start on standard error: loading libraries, and compiling kernels.

On a machine that has run nothing yet, kernels are compiled for half a minute and more; a command
that said nothing meanwhile would look as if it hung. Where they are compiled already, nothing is
printed.
"""

from __future__ import annotations

import os
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from drivora_service.cli.terminal.output import say
from drivora_service.compilation.compilation_progress import (
    VARIABLE,
    CompilationProgress,
    read_compilation_progress,
)
from drivora_service.compilation.machine_code_files import has_machine_code

KERNELS_OF_A_START = 113
"""Kernels that the warm-up of workers compiles; a test compares it with a real start."""

_EVERY_S = 2.5
"""Seconds between two lines. A log of a start has about fifteen, once on a machine."""

_POLL_S = 0.2


class StartLines:
    """Makes the lines of a start from its progress."""

    def __init__(self, *, is_first: bool, now: float) -> None:
        """Begins at a time.

        Args:
            is_first: Whether no kernel was compiled on this machine before.
            now: Seconds of a clock that never goes back.
        """
        self._is_first, self._begun, self._said_at = is_first, now, now
        self._kernels = 0
        self._is_over = False

    def line(self, progress: CompilationProgress, now: float) -> str:
        """Returns the line that is due; "" if there is none."""
        seconds = now - self._begun
        has_compiled = progress.kernels > self._kernels
        if progress.ready and not self._is_over:
            self._is_over = True
            if self._is_first or progress.kernels:
                return self._say(progress, now, f"workers are ready, after {seconds:.0f} s")
        # The first kernel is announced at once.
        at_once = has_compiled and not self._kernels
        if not at_once and now - self._said_at < _EVERY_S:
            return ""
        if self._is_over:
            # An agent or an oracle that the warm-up does not run.
            if has_compiled:
                return self._say(progress, now, f"compiled {progress.kernels} kernels so far")
        elif progress.kernels:
            return self._say(
                progress,
                now,
                f"compiling kernels, once on this machine: {progress.kernels} of about "
                f"{KERNELS_OF_A_START}, {seconds:.0f} s",
            )
        elif self._is_first:
            return self._say(progress, now, f"loading libraries for the first run, {seconds:.0f} s")
        return ""

    def _say(self, progress: CompilationProgress, now: float, line: str) -> str:
        self._kernels, self._said_at = progress.kernels, now
        return line


@contextmanager
def start_progress() -> Iterator[None]:
    """Prints the progress of the fork server that is started meanwhile, and of its children."""
    with tempfile.TemporaryDirectory(prefix="drivora-start-") as folder:
        file = Path(folder) / "progress"
        file.touch()
        ended = threading.Event()
        lines = StartLines(is_first=not has_machine_code(), now=time.monotonic())
        before = os.environ.get(VARIABLE)
        os.environ[VARIABLE] = str(file)
        thread = threading.Thread(target=_print_lines, args=(lines, file, ended), daemon=True)
        thread.start()
        try:
            yield
        finally:
            ended.set()
            thread.join()
            if before is None:
                del os.environ[VARIABLE]
            else:
                os.environ[VARIABLE] = before


def _print_lines(lines: StartLines, file: Path, ended: threading.Event) -> None:
    while not ended.wait(_POLL_S):
        line = lines.line(read_compilation_progress(file), time.monotonic())
        if line:
            # Whole lines: a display of rich puts them above itself.
            say(line, is_error=True)
