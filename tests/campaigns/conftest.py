"""Parts of campaigns."""

from __future__ import annotations

import copy
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.store.database import Database, open_database


@pytest.fixture
def content() -> dict[str, Any]:
    """A small campaign, as a document; its oracles are violated often."""
    return {
        "name": "crossing",
        "tester": {"name": "random"},
        "agent": {"name": "idm"},
        "scenario": copy.deepcopy(SCENARIO),
        "space": {"vehicles": 2, "walkers": 2},
        "oracles": ["collision", "discomfort"],
        "budget": {"simulations": 12},
        "seed": 3,
    }


@pytest.fixture
def database(tmp_path: Path, empty_database: Path) -> Iterator[Database]:
    file = shutil.copy(empty_database, tmp_path / "drivora.sqlite3")
    opened = open_database(f"sqlite:///{file}")
    yield opened
    opened.close()
