"""A database for each test."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from drivora_service.store.database import Database, open_database


@pytest.fixture
def database(tmp_path: Path, empty_database: Path) -> Iterator[Database]:
    (tmp_path / "data").mkdir(mode=0o700)
    file = shutil.copy(empty_database, tmp_path / "data" / "drivora.sqlite3")
    opened = open_database(f"sqlite:///{file}")
    yield opened
    opened.close()
