"""A real service whose trace files are damaged, exchanged or removed below it."""

from __future__ import annotations

import json
import os
import random
import shutil
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from typer.testing import CliRunner

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.cli.main import app
from drivora_service.observations.trace_files.trace_file import METADATA_KEY
from tests.api.conftest import wait_until_final
from tests.forked_service import forked_service
from tests.hostile_names import acting_characters

PARQUET = "application/vnd.apache.parquet"
ARROW = "application/vnd.apache.arrow.stream"
ANSWERS = (
    ("observations", "application/x-ndjson"),
    ("observations?first=3&last=5", "application/x-ndjson"),
    ("observations", PARQUET),
    ("observations?first=3&last=5", PARQUET),
    ("observations", ARROW),
    ("observations?first=3&last=5&column=x", ARROW),
    ("timeline", "application/json"),
    ("series", "application/json"),
    ("series", ARROW),
    ("perception", "application/json"),
    ("perception", ARROW),
    ("picture", "image/svg+xml"),
)
"""All that is computed from the trace of a run."""
REMEMBERED_S = 0.6
"""After which no answer is given again from memory."""


@dataclass(frozen=True)
class Recorded:
    """A service with two runs.

    Attributes:
        http: Its client.
        data: Its data folder.
        runs: The runs.
    """

    http: httpx.Client
    data: Path
    runs: tuple[dict[str, Any], ...]

    def file(self, number: int) -> Path:
        """Returns the trace file of a run."""
        run_id = str(self.runs[number]["id"])
        return self.data / "traces" / run_id[-2:] / f"{run_id}.parquet"

    def ask(self, number: int, what: str, form: str) -> httpx.Response:
        """Asks for what is computed from the trace of a run."""
        url = f"/api/v1/runs/{self.runs[number]['id']}/{what}"
        return self.http.get(url, headers={"Accept": form})


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Recorded]:
    data = tmp_path_factory.mktemp("recorded") / "data"
    with (
        forked_service(data, workers=1) as url,
        httpx.Client(base_url=url, timeout=60, verify=False) as http,
    ):
        runs = []
        for agent in ("idm", "scripted"):
            posted = http.post("/api/v1/jobs", json=SCENARIO, params={"agent": agent})
            assert posted.status_code == 202, posted.text
            job = wait_until_final(http, posted.json()["id"])
            runs.append(http.get(job["run_url"]).json())
        assert runs[0]["trace_sha256"] != runs[1]["trace_sha256"]
        yield Recorded(http, data, tuple(runs))


@pytest.fixture
def kept(recorded: Recorded, tmp_path: Path) -> Iterator[Recorded]:
    """The runs, whose files are whole again after the test."""
    for number in (0, 1):
        shutil.copy(recorded.file(number), tmp_path / str(number))
    yield recorded
    for number in (0, 1):
        clear(recorded.file(number))
        shutil.copy(tmp_path / str(number), recorded.file(number))


def clear(file: Path) -> None:
    """Removes what there is at a place: a file, a folder, a link, a pipe."""
    if file.is_dir() and not file.is_symlink():
        shutil.rmtree(file)
    else:
        file.unlink(missing_ok=True)


def flip(recorded: Recorded) -> None:
    file = recorded.file(0)
    content = bytearray(file.read_bytes())
    middle = len(content) // 2
    content[middle : middle + 64] = bytes(byte ^ 0xFF for byte in content[middle : middle + 64])
    file.write_bytes(content)


def exchange(recorded: Recorded) -> None:
    one, other, aside = recorded.file(0), recorded.file(1), recorded.data / "aside"
    one.rename(aside)
    other.rename(one)
    aside.rename(other)


def truncate(recorded: Recorded) -> None:
    file = recorded.file(0)
    file.write_bytes(file.read_bytes()[:5000])


def delete(recorded: Recorded) -> None:
    recorded.file(0).unlink()


def empty(recorded: Recorded) -> None:
    recorded.file(0).write_bytes(b"")


def overwrite(recorded: Recorded) -> None:
    file = recorded.file(0)
    file.write_bytes(random.Random(0).randbytes(file.stat().st_size))


def write_text(recorded: Recorded) -> None:
    recorded.file(0).write_text("<script>alert(1)</script>\x1b[2J" * 500)


def write_other_table(recorded: Recorded) -> None:
    pq.write_table(pa.table({"step": [1, 2, 3]}), recorded.file(0))


def declare_many_steps(recorded: Recorded) -> None:
    """The table is that of the run; its header asks for more memory than there is."""
    table = pq.read_table(recorded.file(0))
    header = json.loads(table.schema.metadata[METADATA_KEY])
    header["steps"] = 10**13
    metadata = {METADATA_KEY: json.dumps(header).encode()}
    pq.write_table(table.replace_schema_metadata(metadata), recorded.file(0))


def make_folder(recorded: Recorded) -> None:
    recorded.file(0).unlink()
    (recorded.file(0) / "inside").mkdir(parents=True)


def make_pipe(recorded: Recorded) -> None:
    recorded.file(0).unlink()
    os.mkfifo(recorded.file(0))


def link_outside(recorded: Recorded) -> None:
    recorded.file(0).unlink()
    recorded.file(0).symlink_to("/etc/passwd")


def link_other(recorded: Recorded) -> None:
    recorded.file(0).unlink()
    recorded.file(0).symlink_to(recorded.file(1))


def link_itself(recorded: Recorded) -> None:
    recorded.file(0).unlink()
    recorded.file(0).symlink_to(recorded.file(0).name)


def link_nothing(recorded: Recorded) -> None:
    recorded.file(0).unlink()
    recorded.file(0).symlink_to(recorded.data / "gone.parquet")


DAMAGES = (
    pytest.param(empty, 409, {"trace_unreadable"}, id="empty"),
    pytest.param(overwrite, 409, {"trace_unreadable"}, id="other-bytes"),
    pytest.param(write_text, 409, {"trace_unreadable"}, id="text"),
    pytest.param(write_other_table, 409, {"trace_unreadable"}, id="other-table"),
    pytest.param(declare_many_steps, 409, {"trace_unreadable"}, id="many-steps"),
    pytest.param(make_folder, 409, {"trace_unreadable"}, id="folder"),
    pytest.param(make_pipe, 409, {"trace_unreadable"}, id="pipe"),
    pytest.param(link_outside, 409, {"trace_unreadable"}, id="link-outside"),
    pytest.param(link_other, 409, {"trace_differs"}, id="link-other"),
    pytest.param(link_itself, 409, {"trace_unreadable"}, id="link-itself"),
    pytest.param(link_nothing, 404, {"trace_missing"}, id="link-nothing"),
    pytest.param(flip, 409, {"trace_differs", "trace_unreadable"}, id="flipped"),
    pytest.param(exchange, 409, {"trace_differs"}, id="exchanged"),
    pytest.param(truncate, 409, {"trace_unreadable"}, id="truncated"),
    pytest.param(delete, 404, {"trace_missing"}, id="deleted"),
)


@pytest.mark.parametrize(("damage", "status", "codes"), DAMAGES)
def test_nothing_is_shown_of_a_damaged_trace(
    kept: Recorded, damage: Callable[[Recorded], None], status: int, codes: set[str]
) -> None:
    run_id, sha256 = kept.runs[0]["id"], kept.runs[0]["trace_sha256"]
    time.sleep(REMEMBERED_S)
    damage(kept)
    said = set()
    for what, form in ANSWERS:
        answer = kept.ask(0, what, form)
        assert answer.status_code == status, (what, form, answer.text)
        assert answer.headers["Content-Type"] == "application/problem+json"
        problem = answer.json()
        (item,) = problem["problems"]
        assert item["code"] in codes
        assert item["message"] == problem["detail"]
        said.add(problem["detail"])
    # One problem, whatever was asked for.
    (detail,) = said
    assert detail.startswith(f"run {run_id}: its trace file {run_id}.parquet ")
    assert sha256 in detail
    assert f"`drivora replay {run_id}`" in detail
    assert "Restore the file from a backup" in detail
    assert "root:" not in detail, "nothing of a file outside is shown"
    has_time = damage not in (delete, make_folder, make_pipe, link_itself, link_nothing)
    assert ("The file was last written at " in detail) == has_time
    assert acting_characters(detail) == []
    if damage is exchange:
        assert kept.runs[1]["trace_sha256"] in detail
        assert kept.ask(1, "timeline", "application/json").status_code == 409
    else:
        assert kept.ask(1, "observations", PARQUET).status_code == 200
    # Verdicts are stored in the database, and stay readable.
    assert kept.http.get(f"/api/v1/runs/{run_id}").json()["verdicts"] == kept.runs[0]["verdicts"]
    log = (kept.data / "service.log").read_text()
    assert "trace_damaged" in log
    assert str(kept.file(0)) in log
    assert "Traceback" not in log


@pytest.mark.parametrize(("damage", "status", "codes"), DAMAGES)
def test_damage_is_found_after_the_trace_was_checked(
    kept: Recorded, damage: Callable[[Recorded], None], status: int, codes: set[str]
) -> None:
    for what, form in ANSWERS[:6]:
        assert kept.ask(0, what, form).status_code == 200
    damage(kept)
    time.sleep(REMEMBERED_S)
    for what, form in ANSWERS[:6]:
        assert kept.ask(0, what, form).status_code == status


@pytest.mark.parametrize(("damage", "status", "codes"), DAMAGES)
def test_a_damaged_trace_is_not_judged_again(
    kept: Recorded, damage: Callable[[Recorded], None], status: int, codes: set[str]
) -> None:
    whole = CliRunner().invoke(app, ["rejudge", str(kept.data)])
    assert "Traces: 2; compared: 2; changed: 0; damaged: 0" in whole.output
    assert whole.exit_code == 0
    damage(kept)
    damaged = 2 if damage is exchange else 1
    for place in (kept.data, kept.data / "traces"):
        result = CliRunner().invoke(app, ["rejudge", str(place)])
        assert result.exit_code == 3, result.output
        counts = f"compared: {2 - damaged}; changed: 0; damaged: {damaged}"
        assert f"Traces: 2; {counts}" in result.output
        lines = [line for line in result.output.splitlines() if ": its trace file " in line]
        assert len(lines) == damaged
    run_id = kept.runs[0]["id"]
    arguments = ["--server", str(kept.http.base_url), run_id]
    asked = CliRunner().invoke(app, ["rejudge", *arguments])
    assert asked.exit_code == 3, asked.output
    assert f"run {run_id}: its trace file {run_id}.parquet" in asked.output


def test_runs_of_a_service_are_judged_by_their_ids(recorded: Recorded) -> None:
    run_ids = [run["id"] for run in recorded.runs]
    server = ["--server", str(recorded.http.base_url)]
    result = CliRunner().invoke(app, ["rejudge", *server, *run_ids])
    assert result.exit_code == 0, result.output
    assert "Traces: 2; compared: 2; changed: 0; damaged: 0" in result.output
    unknown = CliRunner().invoke(app, ["rejudge", *server, "0" * 24])
    assert unknown.exit_code == 3
    assert f"unknown run '{'0' * 24}'" in unknown.output
