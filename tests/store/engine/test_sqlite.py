"""What a process keeps of an SQLite database in memory."""

from __future__ import annotations

from pathlib import Path

from sqlalchemy import make_url, text

from drivora_service.store.engine.sqlite import sqlite_engine


def test_the_caches_of_all_connections_have_one_bound(tmp_path: Path) -> None:
    engine = sqlite_engine(make_url(f"sqlite:///{tmp_path / 'a.sqlite3'}"), patience_s=1.0)
    try:
        with engine.connect() as connection:
            bound = connection.execute(text("PRAGMA soft_heap_limit")).scalar_one()
    finally:
        engine.dispose()
    assert 0 < bound <= 16 << 20
