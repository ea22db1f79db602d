"""The progress of compiling kernels, from the processes that compile to the one that shows it.

A process that compiles appends a byte to a file for each kernel; processes that are forked from it
append to the same file. The file is named by an environment variable, as the process that compiles
is the fork server of workers, which inherits only the environment.
"""

from __future__ import annotations

import contextlib
import os
from dataclasses import dataclass
from pathlib import Path

VARIABLE = "DRIVORA_COMPILATION_PROGRESS"
"""Environment variable with the path of the file."""

_KERNEL, _READY = b"k", b"r"


@dataclass(frozen=True, slots=True)
class CompilationProgress:
    """How far the processes are that write to a file.

    Attributes:
        kernels: Kernels that they have compiled.
        ready: Whether the fork server has prepared everything for workers.
    """

    kernels: int = 0
    ready: bool = False


def read_compilation_progress(file: Path) -> CompilationProgress:
    """Returns the progress in a file; that of a file that cannot be read is zero."""
    try:
        content = file.read_bytes()
    except OSError:
        return CompilationProgress()
    return CompilationProgress(content.count(_KERNEL), _READY in content)


def note_ready() -> None:
    """Records that this process is ready to start workers, if a file is named."""
    if VARIABLE in os.environ:
        _append(_READY)


def note_kernel() -> None:
    """Records that this process has compiled a kernel, if a file is named."""
    if VARIABLE in os.environ:
        _append(_KERNEL)


def _append(mark: bytes) -> None:
    # Progress that cannot be written, such as on a full disk, must not end a worker.
    with contextlib.suppress(OSError):
        # Not created again once its reader has removed it.
        file = os.open(os.environ[VARIABLE], os.O_WRONLY | os.O_APPEND)
        try:
            os.write(file, mark)
        finally:
            os.close(file)
