"""The files of a service are for its owner only, under any umask."""

from __future__ import annotations

import os
import stat
import time
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.cli.application.service_process import run_service
from tests.api.test_campaigns import small_campaign
from tests.command_process import begin

PREFIX = "/api/v1"
UMASK = 0o022


@pytest.fixture
def open_umask() -> Iterator[None]:
    before = os.umask(UMASK)
    yield
    os.umask(before)


def open_to_others(folder: Path) -> dict[str, str]:
    """Returns the modes of all files and folders that anyone but the owner may use."""
    modes = {path: stat.S_IMODE(path.lstat().st_mode) for path in (folder, *folder.rglob("*"))}
    return {
        str(path.relative_to(folder)): f"{mode:o}" for path, mode in modes.items() if mode & 0o77
    }


def follow(client: httpx.Client, url: str, key: str, final: set[str]) -> None:
    deadline = time.monotonic() + 300
    while (found := client.get(url).json())[key] not in final:
        assert time.monotonic() < deadline, found
        time.sleep(0.2)


def drivora(folder: Path, *arguments: str | Path) -> None:
    log = folder / "printed"
    environment = dict(os.environ)
    begun = begin(*arguments, folder=folder, environment=environment, out=log, err=log, umask=UMASK)
    assert begun.wait(300) == 0, log.read_text()


@pytest.mark.usefixtures("open_umask")
def test_every_file_of_a_run_a_campaign_and_a_backup_is_private(tmp_path: Path) -> None:
    data, backup = tmp_path / "data", tmp_path / "backup"
    with run_service(data, workers=1) as url, httpx.Client(base_url=url, timeout=60) as client:
        job = client.post(f"{PREFIX}/jobs", json=SCENARIO).headers["Location"]
        campaign = client.post(f"{PREFIX}/campaigns", json=small_campaign("random"))
        follow(client, job, "status", {"finished"})
        follow(client, campaign.headers["Location"], "state", {"finished"})
        drivora(tmp_path, "tokens", "create", "ci", "--data-dir", data)
        drivora(tmp_path, "store", "backup", backup, "--data-dir", data)
        names = {path.name for path in data.rglob("*")}
        assert {"drivora.sqlite3", "drivora.sqlite3-wal", "service.json", "tokens.json"} <= names
        assert list(data.glob("traces/**/*.parquet"))
        assert list(data.glob("campaigns/**/*"))
        assert open_to_others(data) == {}
        assert open_to_others(backup) == {}
