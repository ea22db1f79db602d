"""What runs in the process of a command."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from pathlib import Path


def run_command(
    arguments: Sequence[str], folder: Path, environment: dict[str, str], out: Path, err: Path
) -> None:
    """Is ``drivora`` with these arguments: ends as it does, with its exit code."""
    os.chdir(folder)
    os.environ.clear()
    os.environ.update(environment)
    for path, descriptor in ((out, 1), (err, 2)):
        file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(file, descriptor)
        os.close(file)
    sys.argv = ["drivora", *arguments]
    from drivora_service.cli.main import app

    app()
