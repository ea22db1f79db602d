"""The folders of servers in a data folder."""

from __future__ import annotations

import os
import socket
import time
from pathlib import Path

import pytest

from drivora_service.errors import Conflict
from drivora_service.store.locks.server_folder import ServerFolder


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


def aged(folder: Path, days: float) -> Path:
    """A folder with a log, both of some days ago."""
    folder.mkdir(parents=True)
    (folder / "slot-0.log").write_text("of a worker")
    then = time.time() - days * 86_400.0
    for path in (folder / "slot-0.log", folder):
        os.utime(path, (then, then))
    return folder


def test_what_nobody_has_used_for_a_week_is_removed(tmp_path: Path) -> None:
    host = socket.gethostname()
    used = ServerFolder(tmp_path, is_shared=True)
    old_node, node = aged(used.logs / "node-a", 8), aged(used.logs / "node-b", 6)
    log = used.logs / "slot-0.log"
    log.write_text("of a worker of this machine")
    os.utime(log, (0, 0))
    old_pod, pod = (aged(tmp_path / "servers" / f"pod-{days}-1", days) for days in (8, 6))
    os.utime(used.path / "server.lock", (0, 0))
    second = ServerFolder(tmp_path, is_shared=True)
    # The first one is in use, however old it is.
    assert sorted(path.name for path in (tmp_path / "servers").iterdir()) == sorted(
        (f"{host}-1", f"{host}-2", pod.name)
    )
    assert not old_pod.exists()
    used.release()
    again = ServerFolder(tmp_path, is_shared=True)
    assert again.path == used.path
    assert (old_node.exists(), node.exists(), log.exists()) == (False, True, True)
    for one in (second, again):
        one.release()
