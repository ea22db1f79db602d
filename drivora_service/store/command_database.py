"""The database of a command."""

from __future__ import annotations

import threading
from collections.abc import Callable
from functools import partial
from pathlib import Path

from drivora_service.errors import NothingStored
from drivora_service.store.database import (
    Database,
    database_file,
    make_data_folder,
    open_database,
)
from drivora_service.store.engine.storage_faults import make_folder_error
from drivora_service.store.locks.server_lock import refuse_while_served


class CommandDatabase:
    """The database of a command, opened when it is needed."""

    def __init__(
        self,
        data_dir: Path,
        url: str,
        *,
        makes_data: bool,
        on_opened: Callable[[Database], None] = lambda _database: None,
    ) -> None:
        """Creates the access to the database; nothing is opened or created yet.

        Args:
            data_dir: Data folder.
            url: SQLAlchemy address of the database.
            makes_data: Whether data folder and database are made if they do not exist.
            on_opened: Called with the opened database before it is used.
        """
        self._data_dir, self._url, self._makes_data = data_dir, url, makes_data
        self._on_opened = on_opened
        self._opening = threading.Lock()
        self._database: Database | None = None

    def __call__(self) -> Database:
        """Returns the database.

        Raises:
            NothingStored: It does not exist, and is not to be made.
            Conflict: It is to be migrated, and a server or a command works on it.
            StoreError: It cannot be used.
        """
        with self._opening:
            if self._database is None:
                self._database = self._open()
            return self._database

    def close(self) -> None:
        """Closes every connection."""
        if self._database is not None:
            self._database.close()

    def _open(self) -> Database:
        if self._makes_data:
            make_data_folder(self._data_dir)
        else:
            file = database_file(self._url)
            if file is not None and (fault := _find_nothing(file)):
                raise NothingStored(
                    f"no data is stored in {file.parent}: {fault}; choose a data folder with "
                    "--data-dir or DRIVORA_DATA_DIR, or store runs with `drivora run`"
                )
        database = open_database(
            self._url, before_migration=partial(refuse_while_served, self._data_dir)
        )
        try:
            self._on_opened(database)
        except BaseException:
            database.close()
            raise
        return database


def _find_nothing(file: Path) -> str:
    """Returns why a file is no database that could be read; "" if it may be one.

    Raises:
        StoreError: Its folder cannot be read.
    """
    try:
        # SQLite makes the file empty and writes its first page at once.
        size = file.stat().st_size
    except (FileNotFoundError, NotADirectoryError):
        return f"there is no {file.name}"
    except OSError as error:
        raise make_folder_error(file.parent, error) from error
    if file.is_dir():
        return f"{file.name} is a folder, not a database"
    return "" if size else f"{file.name} is empty"
