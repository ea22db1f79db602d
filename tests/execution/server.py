"""A server process of the tests: dispatches from a data folder until it is killed or done."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from multiprocessing.connection import Connection
from pathlib import Path

from drivora_service.execution.dispatcher import Dispatcher
from drivora_service.execution.infrastructure import Infrastructure
from drivora_service.execution.local import LocalExecutor
from drivora_service.runs.run_report import RunStatus
from drivora_service.store.database import Database, open_database
from drivora_service.store.locks.server_lock import ServerLock
from drivora_service.store.runs.run_records import JobFilter
from drivora_service.store.traces.trace_folders import TraceFolder
from tests.command_process import use_fork_server
from tests.execution.owners import server


def forked(data_dir: Path, fork_server: str, told: Connection) -> None:
    """Serves ``data_dir`` with workers from the fork server at an address.

    Args:
        data_dir: The data folder.
        fork_server: The address.
        told: Gets a message once it serves.
    """
    use_fork_server(fork_server)
    main(data_dir, lambda: told.send("serving"))


def main(data_dir: Path, on_start: Callable[[], None] = lambda: None) -> None:
    """Serves ``data_dir``; ends when nothing is left to do."""
    lock = ServerLock(data_dir)
    database = open_database(f"sqlite:///{data_dir / 'drivora.sqlite3'}")
    executor = LocalExecutor(
        slots=2,
        setup=None,
        folder=data_dir / "workers",
        perform="tests.execution.worker_tasks:perform",
        warm_up="",
    )
    traces = TraceFolder(data_dir / "traces")
    infrastructure = Infrastructure({"database": database.probe})
    dispatcher = Dispatcher(database, executor, traces, infrastructure, server(database, data_dir))
    dispatcher.start()
    on_start()
    while any(slot.run_id for slot in executor.slots()) or waiting(database):
        time.sleep(0.05)
    dispatcher.stop(drain_s=5.0)
    executor.close()
    database.close()
    lock.release()


def waiting(database: Database) -> bool:
    unfinished = JobFilter(statuses=frozenset({RunStatus.QUEUED, RunStatus.RUNNING}))
    with database.read() as transaction:
        return bool(transaction.jobs.page(unfinished, limit=1).items)


if __name__ == "__main__":
    main(Path(sys.argv[1]), lambda: print("serving", flush=True))
