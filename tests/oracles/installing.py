"""Packages with oracles, as an installer would have left them."""

from __future__ import annotations

import importlib
import shutil
from pathlib import Path

import pytest

PACKAGE = "foreign-oracles"


def install_oracles(site: Path, monkeypatch: pytest.MonkeyPatch, *names: str) -> None:
    """Makes oracles of ``foreign_oracles.py`` a distribution that Python finds on its path.

    A name of the form ``name=module:attribute`` is an entry point as it stands.
    """
    site.mkdir(exist_ok=True)
    shutil.copy(Path(__file__).with_name("foreign_oracles.py"), site)
    info = site / "foreign_oracles-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {PACKAGE}\nVersion: 1.0\n")
    points = [name if "=" in name else f"{name} = foreign_oracles:{name}" for name in names]
    text = "\n".join(["[drivora_service.oracles]", *points, ""])
    (info / "entry_points.txt").write_text(text)
    monkeypatch.syspath_prepend(str(site))
    importlib.invalidate_caches()
