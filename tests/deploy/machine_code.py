"""Machine code of the checkout, for packages that are installed from it."""

from __future__ import annotations

import shutil
from pathlib import Path


def copy_machine_code(package: Path, installed: Path) -> None:
    """Copies the machine code of the checkout, if there is any, to an installed package.

    It is valid for files that have the same content and are as old.
    """
    for code in package.rglob("__pycache__/*.nb[ci]"):
        target = installed / code.relative_to(package)
        # What is installed without bytecode has no such folder yet.
        target.parent.mkdir(exist_ok=True)
        shutil.copy(code, target)
    for source in package.rglob("*.py"):
        target = installed / source.relative_to(package)
        if target.is_file():
            assert target.read_bytes() == source.read_bytes()
            shutil.copystat(source, target)
