"""The checks of the data folder, its database, its server and the port."""

from __future__ import annotations

import socket
import sqlite3
import threading
from collections.abc import Iterator
from contextlib import closing, contextmanager
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path

import pytest

from drivora_service.cli.doctor.data_checks import (
    check_data_folder,
    check_database,
    check_port,
    check_server,
    check_tokens,
)
from drivora_service.cli.doctor.findings import State, publishable
from drivora_service.settings import Settings
from drivora_service.store.database import open_database
from drivora_service.store.locks.server_lock import ServerLock
from drivora_service.store.migration import newest_revision


@pytest.fixture
def settings(tmp_path: Path) -> Settings:
    return Settings(data_dir=tmp_path)


def make_database(settings: Settings) -> Path:
    open_database(settings.resolved_database_url).close()
    return settings.data_dir / "drivora.sqlite3"


def set_schema(file: Path, revision: str) -> None:
    with closing(sqlite3.connect(file)) as connection, connection:
        connection.execute("UPDATE alembic_version SET version_num = ?", (revision,))


def test_databases_of_all_ages_are_told_apart(settings: Settings) -> None:
    (none,) = check_database(settings)
    assert none.state is State.OK
    assert "none yet" in none.found
    file = make_database(settings)
    (current,) = check_database(settings)
    assert current.state is State.OK
    assert f"schema {newest_revision()}, that of this version" in current.found
    set_schema(file, "0001")
    (older,) = check_database(settings)
    assert (older.state, older.found[:23]) == (State.NOTE, "schema 0001, older than")
    set_schema(file, "9999")
    (newer,) = check_database(settings)
    assert (newer.state, newer.found[:23]) == (State.PROBLEM, "schema 9999, newer than")


def test_a_file_that_is_no_database_is_a_problem(settings: Settings) -> None:
    (settings.data_dir / "drivora.sqlite3").write_bytes(b"no database" * 1000)
    (found,) = check_database(settings)
    assert found.state is State.PROBLEM
    assert "file is not a database" in found.found


def test_a_folder_that_is_none_is_a_problem(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    (found,) = check_data_folder(Settings(data_dir=tmp_path / "file" / "data"))
    assert (found.state, found.found) == (State.PROBLEM, f"{tmp_path / 'file'} is no folder")


def test_a_server_on_the_folder_is_named(settings: Settings) -> None:
    assert not [*check_server(settings)]
    lock = ServerLock(settings.data_dir)
    try:
        (settings.data_dir / "service.json").write_text('{"url": "http://127.0.0.1:8123"}')
        (found,) = check_server(settings)
    finally:
        lock.release()
    assert found.state is State.NOTE
    assert "serves this data folder at http://127.0.0.1:8123" in found.found


def test_tokens_are_needed_beyond_loopback(tmp_path: Path) -> None:
    (inside,) = check_tokens(Settings(data_dir=tmp_path))
    (outside,) = check_tokens(Settings(data_dir=tmp_path, host="0.0.0.0"))
    assert (inside.state, outside.state) == (State.OK, State.PROBLEM)
    (tmp_path / "tokens.json").write_text("[]")
    (revoked,) = check_tokens(Settings(data_dir=tmp_path))
    assert (revoked.state, revoked.found) == (State.PROBLEM, "none, and all were revoked")
    (tmp_path / "tokens.json").write_text("{")
    (damaged,) = check_tokens(Settings(data_dir=tmp_path))
    assert damaged.state is State.PROBLEM
    assert "cannot be used" in damaged.found


@contextmanager
def answering(body: bytes) -> Iterator[int]:
    """A program that answers HTTP on a port."""

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self.send_response(200)
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, format: str, *args: object) -> None:  # noqa: A002  # named by the standard library
            pass

    server = HTTPServer(("127.0.0.1", 0), Handler)
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    try:
        yield server.server_port
    finally:
        server.shutdown()
        thread.join()
        server.server_close()


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        (b'{"status": "ok", "version": "0.0.7"}', "taken by Drivora 0.0.7 (this is "),
        (b"<html>", "taken by another program (BaseHTTP"),
    ],
)
def test_the_program_at_the_port_is_named(tmp_path: Path, body: bytes, expected: str) -> None:
    with answering(body) as port:
        (found,) = check_port(Settings(data_dir=tmp_path, port=port))
    assert found.state is State.NOTE
    assert expected in found.found


def test_a_port_without_http_and_a_free_one(tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        port = listener.getsockname()[1]
        listener.listen()
        threading.Thread(target=lambda: listener.accept()[0].close(), daemon=True).start()
        (taken,) = check_port(Settings(data_dir=tmp_path, port=port))
    (free,) = check_port(Settings(data_dir=tmp_path, port=port))
    assert (taken.state, free.state) == (State.NOTE, State.OK)
    assert "no program there answers HTTP" in taken.found


def test_what_is_published_names_no_home_and_no_password(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", "/home/ann")
    text = "/home/ann/data, /home/anna, s3://key:secret@store/x, 'http://u@h' in /home/ann"
    assert publishable(text) == "~/data, /home/anna, s3://store/x, 'http://h' in ~"
