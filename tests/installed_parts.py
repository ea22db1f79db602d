"""The package of ``own_parts.py``, as an installer would have left it."""

from __future__ import annotations

import importlib
import shutil
import sys
from pathlib import Path

import pytest

PACKAGE = "own-parts"
PARTS = """\
[drivora_service.oracles]
walker_runs = own_parts:ORACLE
[drivora_service.metrics]
walker_speed_mps = own_parts:METRIC
[drivora_service.testers]
own-climber = own_parts:TESTER
[drivora_service.agents]
parker = own_parts:AGENT
"""


def install_parts(
    site: Path, monkeypatch: pytest.MonkeyPatch, *, parts: str = PARTS, code: str = ""
) -> None:
    """Makes the parts a distribution that Python finds on its path.

    Args:
        site: Folder that becomes a part of the path.
        monkeypatch: Takes it from the path at the end of a test.
        parts: Its entry points.
        code: Further code of its module ``more_parts``.
    """
    info = site / "own_parts-0.1.dist-info"
    info.mkdir(parents=True)
    shutil.copy(Path(__file__).with_name("own_parts.py"), site)
    (site / "more_parts.py").write_text(code)
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {PACKAGE}\nVersion: 0.1\n")
    (info / "entry_points.txt").write_text(parts)
    # Another test may have imported modules of these names from a folder of its own.
    for module in ("own_parts", "more_parts"):
        sys.modules.pop(module, None)
    monkeypatch.syspath_prepend(str(site))
    importlib.invalidate_caches()


def uninstall_parts(site: Path) -> None:
    """Removes the distribution, as an installer would."""
    shutil.rmtree(site)
    site.mkdir()
    importlib.invalidate_caches()
