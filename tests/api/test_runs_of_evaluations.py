"""Runs of the campaigns of commands, which no queue has, are shown like others."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
import yaml
from typer.testing import CliRunner

from drivora_service.cli.main import app
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
