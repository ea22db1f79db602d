"""Runs of the campaigns of commands, which no queue has, are shown like others."""

from __future__ import annotations

import shutil
import sqlite3
from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import httpx
import pytest
import yaml
from typer.testing import CliRunner

from drivora_service.cli.main import app
from drivora_service.observations.trace_files.trace_file import read_trace, write_trace
from tests.forked_service import forked_service

_CAMPAIGN = "openscenario_schemas/examples/campaigns/late-braking.yaml"


@pytest.fixture(scope="module")
def command_campaign(repository: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """The data folder of a command that ran a campaign with failures.

    It finds its first failure after 16 simulations, and others if it goes on to its end.
    """
    shipped = repository / _CAMPAIGN
    content = yaml.safe_load(shipped.read_text()) | {"budget": {"simulations": 24}}
    content["scenario"]["file"] = str(shipped.with_name(content["scenario"]["file"]))
    path = tmp_path_factory.mktemp("campaign") / shipped.name
    path.write_text(yaml.safe_dump(content))
    folder = tmp_path_factory.mktemp("command") / "data"
    arguments = ["campaign", "run", str(path), "--data-dir", str(folder)]
    result = CliRunner().invoke(app, [*arguments, "--workers", "2"])
    assert result.exit_code == 0, result.output
    yield folder
    shutil.rmtree(folder)


@pytest.fixture(scope="module")
def service(command_campaign: Path) -> Iterator[httpx.Client]:
    with (
        forked_service(command_campaign, workers=1) as url,
        httpx.Client(base_url=url, timeout=60) as client,
    ):
        yield client


def test_a_failure_leads_to_its_replay(service: httpx.Client) -> None:
    failures = service.get("/api/v1/failures").json()["items"]
    assert failures
    for failure in failures:
        assert failure["is_recorded"]
        run = service.get(failure["run_url"]).json()
        assert run["id"] == f"{failure['campaign_id']}-{failure['evaluation']}"
        assert run["campaign_id"] == failure["campaign_id"]
        assert run["evaluation"] == failure["evaluation"]
        assert run["status"] == "finished"
        assert failure["verdict"] in run["verdicts"]
        assert run["violations"] >= 1
        # The hash is that of the run in the search, the recording that of the second run.
        own = failure["scenario_url"].replace("/scenario", "/observations")
        recorded = service.get(run["observations_url"])
        assert recorded.status_code == 200
        assert recorded.content == service.get(own).content
        assert len(recorded.text.splitlines()) == run["steps"]
        for part in ("timeline", "series", "perception", "scenario"):
            answer = service.get(f"{failure['run_url']}/{part}")
            assert answer.status_code == 200, (part, answer.text)
        document = service.get(f"{failure['run_url']}/scenario").json()
        assert document == service.get(failure["scenario_url"]).json()


def test_a_run_without_failure_says_what_is_recorded(service: httpx.Client) -> None:
    (campaign,) = service.get("/api/v1/campaigns").json()["items"]
    items = service.get(f"/api/v1/campaigns/{campaign['id']}/evaluations").json()["items"]
    passed = next(one for one in items if one["status"] == "judged" and not one["violations"])
    run = service.get(f"/api/v1/runs/{campaign['id']}-{passed['number']}").json()
    assert (run["violations"], run["trace_sha256"], run["observations_url"]) == (0, "", "")
    refused = service.get(f"/api/v1/runs/{run['id']}/observations")
    assert refused.status_code == 404
    assert "failures that were confirmed have a recording" in refused.json()["detail"]


@pytest.mark.parametrize("number", ["999999", "1-2", "again", "-1"])
def test_other_ids_are_unknown(service: httpx.Client, number: str) -> None:
    (campaign,) = service.get("/api/v1/campaigns").json()["items"]
    assert service.get(f"/api/v1/runs/{campaign['id']}-{number}").status_code == 404


@pytest.fixture
def changed(command_campaign: Path, tmp_path: Path) -> Path:
    """A copy of the data folder, to be changed."""
    return shutil.copytree(command_campaign, tmp_path / "changed")


def test_the_second_run_of_a_flaky_failure_is_not_shown_as_the_first(changed: Path) -> None:
    with closing(sqlite3.connect(changed / "drivora.sqlite3")) as connection, connection:
        ((number,),) = connection.execute("SELECT min(number) FROM failures").fetchall()
        for table in ("failures", "found_failures"):
            update = f"UPDATE {table} SET confirmation = 'flaky' WHERE number = ?"
            assert connection.execute(update, (number,)).rowcount
    with (
        forked_service(changed, workers=1) as url,
        httpx.Client(base_url=url, timeout=60, verify=False) as client,
    ):
        (campaign,) = client.get("/api/v1/campaigns").json()["items"]
        evaluation = f"/api/v1/campaigns/{campaign['id']}/evaluations/{number}"
        assert client.get(evaluation).json()["observations_url"] == ""
        failures = client.get(f"/api/v1/campaigns/{campaign['id']}/failures").json()["items"]
        assert [f["observations_url"] == "" for f in failures] == [
            f["evaluation"] == number for f in failures
        ]
        assert all(failure["trace"] for failure in failures), "the file is kept"
        found = client.get("/api/v1/failures").json()["items"]
        assert {f["is_recorded"] for f in found if f["evaluation"] == number} == {False}
        for address in (evaluation, f"/api/v1/runs/{campaign['id']}-{number}"):
            for part in ("observations", "picture"):
                refused = client.get(f"{address}/{part}")
                assert refused.status_code == 404, refused.text
        assert (
            "identical second run confirmed"
            in client.get(f"{evaluation}/observations").json()["detail"]
        )
    # What is not compared is not judged under the verdicts of the first run either.
    result = CliRunner().invoke(app, ["rejudge", str(changed)])
    assert result.exit_code == 0, result.output
    assert f"{number:06d}.trace.parquet: not judged: no recording of it is stored" in result.output
    # A report that would draw the failure leaves it out.
    report = ["campaign", "report", campaign["id"], "--data-dir", str(changed)]
    drawn = CliRunner().invoke(app, [*report, "--out", str(changed / "report")])
    assert drawn.exit_code == 0, drawn.output


def test_the_trace_of_another_run_is_not_shown_as_that_of_an_evaluation(changed: Path) -> None:
    (file,) = changed.glob("campaigns/*/traces/*.parquet")
    recorded = read_trace(file)
    states = recorded.states.copy()
    states[3, 0, 0] += 1.0
    write_trace(replace(recorded, states=states), file)
    with (
        forked_service(changed, workers=1) as url,
        httpx.Client(base_url=url, timeout=60, verify=False) as client,
    ):
        (campaign,) = client.get("/api/v1/campaigns").json()["items"]
        number = int(file.name.partition(".")[0])
        run_id = f"{campaign['id']}-{number}"
        own = f"/api/v1/campaigns/{campaign['id']}/evaluations/{number}"
        for address in (own, f"/api/v1/runs/{run_id}"):
            for part in ("observations", "picture"):
                refused = client.get(f"{address}/{part}")
                assert refused.status_code == 409, refused.text
                assert refused.json()["problems"][0]["code"] == "trace_differs"
                assert f"run {run_id}: its trace file {file.name}" in refused.json()["detail"]
    for place in (changed, changed / "campaigns", file.parent, file):
        result = CliRunner().invoke(app, ["rejudge", str(place)])
        assert result.exit_code == 3, result.output
        assert "Traces: 1; compared: 0; changed: 0; damaged: 1" in result.output
        assert f"{file}: run {run_id}: its trace file {file.name} is damaged" in result.output
    # The report of the campaign has no picture of it, and says why.
    report = ["campaign", "report", campaign["id"], "--data-dir", str(changed)]
    drawn = CliRunner().invoke(app, [*report, "--out", str(changed / "report.md")])
    assert drawn.exit_code == 0, drawn.output
    assert f"no picture of evaluation {number}: " in drawn.output
