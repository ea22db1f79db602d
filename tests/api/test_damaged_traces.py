"""A real service whose trace files are damaged, exchanged or removed below it."""

from __future__ import annotations

import shutil
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx
import pytest
from typer.testing import CliRunner

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.cli.main import app
from tests.api.conftest import wait_until_final
from tests.forked_service import forked_service

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
_REMEMBERED_S = 0.6
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
        shutil.copy(tmp_path / str(number), recorded.file(number))


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


DAMAGES = (
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
    time.sleep(_REMEMBERED_S)
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
    assert ("The file was last written at 2" in detail) == (damage is not delete)
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


@pytest.mark.parametrize(("damage", "status", "codes"), DAMAGES)
def test_damage_is_found_after_the_trace_was_checked(
    kept: Recorded, damage: Callable[[Recorded], None], status: int, codes: set[str]
) -> None:
    for what, form in ANSWERS[:6]:
        assert kept.ask(0, what, form).status_code == 200
    damage(kept)
    time.sleep(_REMEMBERED_S)
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
