"""Campaigns and runs as tables over HTTP."""

from __future__ import annotations

import csv
import io
import json
import re
from typing import Any

import httpx
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from drivora_service.studies.tables import table_forms
from tests.api.conftest import Offline
from tests.api.test_campaigns import finished as finished  # a fixture
from tests.api.test_problem_details import is_problem

Json = dict[str, Any]
PARQUET = "application/vnd.apache.parquet"
ARROW = "application/vnd.apache.arrow.stream"


def in_every_form(http: httpx.Client, url: str) -> list[dict[str, list[Any]]]:
    """The columns of a table, read from each of its forms but CSV."""

    def get(accept: str) -> httpx.Response:
        answer = http.get(url, headers={"Accept": accept})
        assert answer.status_code == 200, answer.text
        return answer

    parquet = pq.read_table(io.BytesIO(get(PARQUET).content))
    with pa.ipc.open_stream(get(ARROW).content) as stream:
        arrow = stream.read_all()
    assert arrow.schema.equals(parquet.schema)
    told = get("application/json").json()
    assert told["rows"] == arrow.num_rows
    assert arrow.to_pydict() == parquet.to_pydict()
    rows = list(csv.DictReader(io.StringIO(get("text/csv").text)))
    assert len(rows) == told["rows"]
    assert list(rows[0]) == list(told["columns"])
    return [parquet.to_pydict(), told["columns"]]


def test_the_evaluations_of_a_campaign_are_a_table(http: httpx.Client, finished: Json) -> None:
    url = f"/api/v1/campaigns/{finished['id']}/tables/evaluations"
    listed = http.get(f"{finished['evaluations_url']}?limit=500").json()["items"]
    objectives = {name for one in listed for name in one["objectives"]}
    assert objectives
    for columns in in_every_form(http, url):
        for name, given in (
            ("evaluation", "number"),
            ("status", "status"),
            ("violations", "violations"),
            ("accountability", "accountability"),
            ("parents", "parents"),
            ("sim_time_s", "sim_time_s"),
        ):
            assert columns[name] == [one[given] for one in listed], name
        for name in objectives:
            found = columns[f"objective.{name}"]
            assert found == [one["objectives"].get(name) for one in listed]
            assert any(value is not None for value in found)
        detail = http.get(f"{finished['evaluations_url']}/{listed[-1]['number']}").json()
        assert columns["genes"][-1] == detail["values"]


def test_the_failures_of_a_campaign_are_a_table(http: httpx.Client, finished: Json) -> None:
    url = f"/api/v1/campaigns/{finished['id']}/tables/failures"
    listed = http.get(f"{finished['failures_url']}?limit=500").json()["items"]
    assert listed
    for columns in in_every_form(http, url):
        for name in ("evaluation", "place", "kind", "confirmation", "group", "trace"):
            assert columns[name] == [one[name] for one in listed], name
        verdicts = [one["verdict"] for one in listed]
        assert columns["time_s"] == [verdict["time"] for verdict in verdicts]
        assert columns["x"] == [verdict["location"][0] for verdict in verdicts]
        assert columns["at_fault"] == [verdict["at_fault"] for verdict in verdicts]
        assert all(sentence.endswith(".") for sentence in columns["sentence"])


def test_the_runs_of_a_campaign_are_a_table(http: httpx.Client, finished: Json) -> None:
    listed = http.get(f"/api/v1/runs?campaign={finished['id']}&order=created_at&limit=500").json()
    items = listed["items"]
    assert len(items) > 10
    query = f"campaign={finished['id']}"
    for columns in in_every_form(http, f"/api/v1/tables/runs?{query}"):
        # All evaluations of a service have runs, and each is in the table once.
        assert columns["run_id"] == [run["id"] for run in items]
        assert set(columns["source"]) == {"run"}
        for name in ("status", "agent", "violations", "label", "town", "steps", "sim_time_s"):
            assert columns[name] == [run[name] for run in items], name
        numbers = [
            number
            for number, confirms in zip(columns["evaluation"], columns["confirms"], strict=True)
            if not confirms and number is not None
        ]
        assert numbers == list(range(finished["counts"]["evaluations"]))
        assert any(columns["confirms"])
        # The run of the seed scenario is of the campaign, and of no evaluation.
        assert columns["evaluation"].count(None) == 1
    details = [http.get(f"/api/v1/runs/{run['id']}").json() for run in items]
    for columns in in_every_form(http, f"/api/v1/tables/verdicts?{query}"):
        verdicts = [verdict for run in details for verdict in run["verdicts"]]
        for name in ("oracle", "ego", "outcome", "at_fault", "avoidable", "message"):
            assert columns[name] == [verdict[name] for verdict in verdicts], name
        evidence = [json.loads(text) for text in columns["evidence"]]
        assert evidence == [verdict["evidence"] for verdict in verdicts]
    for columns in in_every_form(http, f"/api/v1/tables/metrics?{query}"):
        described = zip(columns["kind"], columns["metric"], columns["value"], strict=True)
        assert [(name, value) for kind, name, value in described if kind == "metric"] == [
            pair for run in details for pair in run["metrics"].items()
        ]
        assert {"score", "objective"} < set(columns["kind"])
    for columns in in_every_form(http, f"/api/v1/tables/agents?{query}"):
        assert columns["agent"] == [
            agent["name"] for run in details for agent in run["agents"].values()
        ]


def test_tables_are_filtered_as_lists_are(http: httpx.Client, finished: Json) -> None:
    def found(query: str) -> list[str]:
        answer = http.get(f"/api/v1/tables/runs?{query}&column=run_id")
        assert answer.status_code == 200, answer.text
        return answer.text.splitlines()[1:]

    every = found(f"campaign={finished['id']}")
    for query in ("violated=true", "oracle=collision", "status=invalid", "agent=idm", "town=x"):
        listed = http.get(f"/api/v1/runs?campaign={finished['id']}&{query}&limit=500").json()
        wanted = [run["id"] for run in reversed(listed["items"])]
        assert found(f"campaign={finished['id']}&{query}") == wanted
        assert len(wanted) <= len(every)
    name = finished["name"].replace(" ", "%20")
    assert set(every) <= set(found(f"campaign={name}"))
    assert set(every) <= set(found("campaign=tee*"))
    batch = finished["runs_url"].rpartition("=")[2]
    assert found(f"batch={batch}&campaign={finished['id']}") == every


def test_columns_and_evaluations_are_chosen(http: httpx.Client, finished: Json) -> None:
    url = f"/api/v1/campaigns/{finished['id']}/tables/evaluations"
    wanted: Json = {"column": ["status", "evaluation"], "after": 9}
    answer = http.get(url, params=wanted)
    assert answer.headers["Content-Type"].startswith("text/csv")
    name = re.sub("[ ,]+", "-", finished["name"])
    told = answer.headers["Content-Disposition"]
    assert told == f'attachment; filename="{name}-evaluations.csv"'
    head, *lines = answer.text.splitlines()
    assert head == "status,evaluation"
    assert lines[0].endswith(",10")
    assert len(lines) == finished["counts"]["evaluations"] - 10
    failures = f"/api/v1/campaigns/{finished['id']}/tables/failures"
    every = http.get(failures, headers={"Accept": "application/json"}).json()["columns"]
    some = http.get(f"{failures}?after=5", headers={"Accept": "application/json"}).json()["columns"]
    assert some["evaluation"] == [number for number in every["evaluation"] if number > 5]


def test_what_is_no_table_is_refused(http: httpx.Client, finished: Json) -> None:
    url = f"/api/v1/campaigns/{finished['id']}/tables/evaluations"
    is_problem(http.get(url, params={"column": "speed"}), 404)
    is_problem(http.get(url, headers={"Accept": "image/png"}), 406)
    is_problem(http.get("/api/v1/campaigns/none/tables/failures"), 404)
    is_problem(http.get(f"/api/v1/campaigns/{finished['id']}/tables/runs"), 422)
    is_problem(http.get("/api/v1/tables/runs?page_token=a"), 422)
    is_problem(http.get("/api/v1/tables/failures"), 422)
    for wanted in ("batch", "campaign", "study"):
        refused = is_problem(http.get(f"/api/v1/tables/runs?{wanted}=none"), 404)
        assert f"unknown {wanted} 'none'" in refused["detail"]


def test_too_many_rows_for_json_are_refused(
    offline: Offline, monkeypatch: pytest.MonkeyPatch, scenario: Json
) -> None:
    monkeypatch.setattr(table_forms, "_MOST_JSON_ROWS", 1)
    for _ in range(2):
        assert offline.client.post("/api/v1/jobs", json=scenario).status_code == 202
    url = "/api/v1/tables/runs"
    is_problem(offline.client.get(url, headers={"Accept": "application/json"}), 422)
    assert len(offline.client.get(url).text.splitlines()) == 3
