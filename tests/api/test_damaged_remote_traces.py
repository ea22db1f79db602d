"""A real service whose traces are in a storage that is damaged, or does not answer."""

from __future__ import annotations

import shutil
import time
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
from typer.testing import CliRunner

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.cli.main import app
from tests.api.conftest import wait_until_final
from tests.api.test_damaged_traces import ANSWERS, REMEMBERED_S
from tests.api.test_problem_details import is_problem
from tests.forked_service import forked_service


@pytest.fixture
def remote(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[tuple[httpx.Client, str]]:
    """A client of the service, and the id of a run."""
    (tmp_path / "storage").mkdir()
    monkeypatch.setenv("DRIVORA_TRACES_URL", f"file://{tmp_path / 'storage'}")
    with (
        forked_service(tmp_path / "data", workers=1) as url,
        httpx.Client(base_url=f"{url}/api/v1", timeout=60, verify=False) as http,
    ):
        posted = http.post("/jobs", json=SCENARIO).raise_for_status().json()
        with httpx.Client(base_url=url, timeout=60, verify=False) as root:
            wait_until_final(root, posted["id"])
        yield http, posted["id"]


def test_damage_of_a_storage_is_one_problem_and_that_of_a_copy_is_mended(
    remote: tuple[httpx.Client, str], tmp_path: Path
) -> None:
    http, run_id = remote
    statuses: list[int] = []

    def ask() -> list[httpx.Response]:
        time.sleep(REMEMBERED_S)
        found = [
            http.get(f"/runs/{run_id}/{what}", headers={"Accept": form})
            for what, form in ANSWERS
            # A picture that was drawn of the right trace is kept in memory.
            if what != "picture"
        ]
        statuses[:] = [one.status_code for one in found]
        return found

    ask()
    assert set(statuses) == {200}
    # A copy on this machine is damaged: the storage has the trace still.
    (copy,) = (tmp_path / "data").glob(f"copies/*/{run_id}.parquet")
    size = copy.stat().st_size
    for content in (b"x" * size, b""):
        copy.write_bytes(content)
        ask()
        assert set(statuses) == {200}
    copy.unlink()
    copy.mkdir()
    ask()
    assert set(statuses) == {200}

    (stored,) = (tmp_path / "storage").glob(f"traces/*/{run_id}.parquet")
    whole = stored.read_bytes()
    stored.write_bytes(whole[:3000])
    said = {answer.json()["detail"] for answer in ask()}
    assert set(statuses) == {409}
    (detail,) = said
    assert detail.startswith(f"run {run_id}: its trace file {run_id}.parquet cannot be read (")
    stored.unlink()
    (stored / "inside").mkdir(parents=True)
    ask()
    assert set(statuses) == {404}

    # The storage does not answer.
    shutil.move(tmp_path / "storage", tmp_path / "aside")
    (tmp_path / "storage").symlink_to(tmp_path / "storage")
    for answer in ask():
        assert is_problem(answer, 503)
        assert int(answer.headers["Retry-After"]) > 0
        assert answer.json()["detail"].startswith(f"run {run_id}: its trace cannot be fetched now")
    data = str(tmp_path / "data")
    verified = CliRunner().invoke(app, ["store", "verify", "--hashes", "--data-dir", data])
    assert verified.exit_code == 1, verified.output
    assert f"damaged_trace: {run_id}: cannot be fetched: file://" in verified.output
    log = (tmp_path / "data" / "service.log").read_text()
    assert "trace_storage_failed" in log
    assert "Traceback" not in log

    (tmp_path / "storage").unlink()
    shutil.move(tmp_path / "aside", tmp_path / "storage")
    shutil.rmtree(stored)
    stored.write_bytes(whole)
    ask()
    assert set(statuses) == {200}
