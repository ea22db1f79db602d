"""Campaigns and runs as tables over HTTP."""

from __future__ import annotations

import csv
import io
from typing import Any

import httpx
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from drivora_service.studies import table_forms
from tests.api.conftest import Offline
from tests.api.test_campaigns import finished as finished  # a fixture
from tests.api.test_problems import is_problem

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


def test_the_runs_that_pass_a_filter_are_a_table(http: httpx.Client, finished: Json) -> None:
    query = f"campaign={finished['id']}&order=created_at"
    listed = http.get(f"/api/v1/runs?{query}&limit=500").json()["items"]
    assert len(listed) > 10
    for columns in in_every_form(http, f"/api/v1/runs:table?{query}"):
        for name in ("id", "status", "agent", "violations", "trace_sha256", "revision"):
            assert columns[name] == [run[name] for run in listed], name


def test_columns_and_evaluations_are_chosen(http: httpx.Client, finished: Json) -> None:
    url = f"/api/v1/campaigns/{finished['id']}/tables/evaluations"
    wanted: Json = {"column": ["status", "evaluation"], "after": 9}
    answer = http.get(url, params=wanted)
    assert answer.headers["Content-Type"].startswith("text/csv")
    assert answer.headers["Content-Disposition"] == 'attachment; filename="evaluations.csv"'
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
    is_problem(http.get("/api/v1/runs:table?page_token=a"), 422)


def test_too_many_rows_for_json_are_refused(
    offline: Offline, monkeypatch: pytest.MonkeyPatch, scenario: Json
) -> None:
    monkeypatch.setattr(table_forms, "_MOST_JSON_ROWS", 1)
    for _ in range(2):
        assert offline.client.post("/api/v1/jobs", json=scenario).status_code == 202
    url = "/api/v1/runs:table"
    is_problem(offline.client.get(url, headers={"Accept": "application/json"}), 422)
    assert len(offline.client.get(url).text.splitlines()) == 3
