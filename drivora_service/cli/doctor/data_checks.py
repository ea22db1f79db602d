"""Checks of the data folder, its database and its tokens, and of the port of a service."""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import socket
import sqlite3
from collections.abc import Iterator
from functools import partial
from http.client import HTTPConnection, HTTPException
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING

from drivora_service.cli.doctor.findings import Check, Finding, noted, ok, problem

if TYPE_CHECKING:
    from drivora_service.settings import Settings

_LITTLE_GB = 2.0
"""Free space below which a long campaign may fill the disk: some ten thousand traces."""

_ANSWER_S = 3.0

_ANY = ("0.0.0.0", "::", "")
"""Hosts that stand for all addresses of the machine."""


def data_checks(settings: Settings) -> tuple[Check, ...]:
    """Returns the checks of what the settings name.

    Args:
        settings: The settings of the environment and the options.
    """
    return (
        Check("data folder", partial(check_data_folder, settings)),
        Check("database", partial(check_database, settings)),
        Check("server", partial(check_server, settings)),
        Check("tokens", partial(check_tokens, settings)),
        Check("port", partial(check_port, settings)),
    )


def check_data_folder(settings: Settings) -> Iterator[Finding]:
    """Checks that the data folder can be written, and the space on its disk."""
    folder = settings.data_dir.absolute()
    existing = folder
    while not existing.exists() and existing != existing.parent:
        existing = existing.parent
    if not existing.is_dir():
        yield problem(
            "data folder",
            f"{existing} is no folder",
            "Name another one with --data-dir or DRIVORA_DATA_DIR",
        )
        return
    missing = "" if existing == folder else ", which the first run makes"
    if not os.access(existing, os.W_OK | os.X_OK):
        yield problem(
            "data folder",
            f"{folder}{missing}: {existing} cannot be written by this user",
            "Name another one with --data-dir or DRIVORA_DATA_DIR, or change its owner",
        )
        return
    free = shutil.disk_usage(existing).free / 1e9
    text = f"{folder}{missing}; {free:.1f} GB free"
    if free < _LITTLE_GB:
        yield noted(
            "data folder",
            text,
            "`drivora store prune` removes old runs; or name a folder on another disk",
        )
    else:
        yield ok("data folder", text)


def check_database(settings: Settings) -> Iterator[Finding]:
    """Compares the schema of an existing database with that of this version."""
    if settings.database_url and not settings.database_url.startswith("sqlite"):
        yield ok("database", f"{settings.database_url} (not opened)")
        return
    from drivora_service.store.migration import newest_revision

    file = Path(settings.resolved_database_url.removeprefix("sqlite:///"))
    newest = newest_revision()
    if not file.is_file():
        yield ok("database", f"none yet; this version makes schema {newest}")
        return
    try:
        found = _schema_of(file)
    except sqlite3.Error as error:
        yield problem(
            "database",
            f"{file} cannot be read: {error}",
            "If the file is no database of Drivora, move it away; else copy a backup back",
        )
        return
    size = file.stat().st_size / 1e6
    if found == newest:
        yield ok("database", f"schema {found}, that of this version; {size:.1f} MB")
    elif not found:
        yield problem(
            "database", f"{file} has no schema of Drivora", "Move it away, or name another folder"
        )
    elif found < newest:
        yield noted(
            "database",
            f"schema {found}, older than that of this version ({newest}); {size:.1f} MB",
            "The next command migrates it; `drivora store backup DIR` first keeps a copy",
        )
    else:
        yield problem(
            "database",
            f"schema {found}, newer than that of this version ({newest})",
            "Use the version of Drivora that wrote it, or a newer one; or name another folder",
        )


def _schema_of(file: Path) -> str:
    """Returns the schema of a SQLite database, which is not changed; "" if it has none."""
    address = f"{file.resolve().as_uri()}?mode=ro"
    with contextlib.closing(sqlite3.connect(address, uri=True, timeout=_ANSWER_S)) as connection:
        query = "SELECT count(*) FROM sqlite_master WHERE name = 'alembic_version'"
        if not connection.execute(query).fetchone()[0]:
            return ""
        row = connection.execute("SELECT version_num FROM alembic_version").fetchone()
        return "" if row is None else str(row[0])


def check_server(settings: Settings) -> Iterator[Finding]:
    """Looks for a server that works on the data folder."""
    from drivora_service.store.locks.server_lock import serving_process

    process = serving_process(settings.data_dir)
    if process is None:
        return
    announcement = settings.data_dir / "service.json"
    url = ""
    with contextlib.suppress(OSError, ValueError, KeyError, TypeError):
        url = str(json.loads(announcement.read_text())["url"])
    yield noted(
        "server",
        f"process {process} serves this data folder{' at ' + url if url else ''}",
        f"Commands may work beside it, or ask it: --server {url or 'URL'}",
    )


def check_tokens(settings: Settings) -> Iterator[Finding]:
    """Counts the tokens, without a look at their secrets, of which only hashes are stored."""
    from drivora_service.api.guards.api_tokens import TokenFile

    path = settings.tokens_path
    file = TokenFile(path, always_needed=settings.always_needs_tokens)
    if file.fault:
        yield problem("tokens", file.fault, "`drivora tokens list` reads the file, too")
        return
    tokens = file.all()
    if file.are_needed and not tokens:
        is_new = settings.always_needs_tokens
        why = f"a service at {settings.host} needs one" if is_new else "all were revoked"
        yield problem("tokens", f"none, and {why}", "`drivora tokens create NAME --scope admin`")
        return
    if path.is_file() and path.stat().st_mode & 0o077:
        yield noted("tokens", f"other users can read {path}", f"chmod 600 {path}")
    scopes = sorted(token.scope.name.lower() for token in tokens)
    yield ok(
        "tokens", ", ".join(scopes) if tokens else "none; none is needed until the first is made"
    )


def check_port(settings: Settings) -> Iterator[Finding]:
    """Looks whether the port of a service is free, and else which program answers there."""
    host, port = settings.host, settings.port
    if port == 0:
        yield ok("port", "0: a free one is chosen")
        return
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    with socket.socket(family, socket.SOCK_STREAM) as listener:
        # As servers do: a port of connections that have just ended counts as free.
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            listener.bind((host, port))
        except OSError as error:
            reason = error.strerror or str(error)
        else:
            yield ok("port", f"{port} on {host} is free")
            return
    who = _program_at("127.0.0.1" if host in _ANY else host, port)
    if not who:
        yield noted(
            "port",
            f"{port} on {host} cannot be used: {reason}; no program there answers HTTP",
            "`drivora serve --port 0` takes a free port",
        )
    else:
        yield noted(
            "port",
            f"{port} on {host} is taken by {who}",
            "Ask that service with --server, or start another one with `drivora serve --port 0`",
        )


def _program_at(host: str, port: int) -> str:
    """Returns which program answers HTTP at an address; "" if none does."""
    connection = HTTPConnection(host, port, timeout=_ANSWER_S)
    try:
        connection.request("GET", "/healthz")
        answer = connection.getresponse()
        content = answer.read(10_000)
        server = answer.getheader("Server", "")
    except (OSError, HTTPException):
        return ""
    finally:
        connection.close()
    with contextlib.suppress(ValueError, KeyError, TypeError):
        version = str(json.loads(content)["version"])
        own = metadata.version("drivora")
        return f"Drivora {version}" + ("" if version == own else f" (this is {own})")
    return f"another program ({server or 'without a name'})"
