"""The folders of servers in a data folder."""

from __future__ import annotations

import socket
from pathlib import Path

import pytest

from drivora_service.errors import Conflict
from drivora_service.store.server_folder import ServerFolder


def test_a_data_folder_that_is_not_shared_has_one_server(tmp_path: Path) -> None:
    mine = ServerFolder(tmp_path, is_shared=False)
    assert mine.path == tmp_path
    with pytest.raises(Conflict, match="already serves"):
        ServerFolder(tmp_path, is_shared=False)
    mine.release()
    ServerFolder(tmp_path, is_shared=False).release()


def test_servers_of_a_shared_folder_have_one_each_and_keep_it(tmp_path: Path) -> None:
    first, second = (ServerFolder(tmp_path, is_shared=True) for _ in range(2))
    host = socket.gethostname()
    assert first.path == tmp_path / "servers" / f"{host}-1"
    assert second.path == tmp_path / "servers" / f"{host}-2"
    first.release()
    again = ServerFolder(tmp_path, is_shared=True)
    assert again.path == first.path
    for one in (second, again):
        one.release()
