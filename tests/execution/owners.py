"""Owners of leases for tests."""

from __future__ import annotations

from pathlib import Path

from drivora_service.execution.ownership import Ownership
from drivora_service.runs.lifecycle import RetryPolicy
from drivora_service.store.database import Database
from drivora_service.store.locks.command_locks import CommandLocks


def server(database: Database, data_dir: Path) -> Ownership:
    """The only server of a data folder."""
    return Ownership(database, RetryPolicy(), CommandLocks(data_dir), exclusive=True)


def command(database: Database, data_dir: Path) -> Ownership:
    """A command that works on a data folder."""
    return Ownership(database, RetryPolicy(), CommandLocks(data_dir), is_command=True)
