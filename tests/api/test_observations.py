from __future__ import annotations

import io
import json
from typing import Any

import httpx
import pyarrow.parquet as pq

PARQUET = {"Accept": "application/vnd.apache.parquet"}


def test_frames_come_as_lines_one_a_step(http: httpx.Client, finished_run: dict[str, Any]) -> None:
    answer = http.get(finished_run["observations_url"])
    assert answer.headers["Content-Type"].startswith("application/x-ndjson")
    frames = [json.loads(line) for line in answer.text.splitlines()]
    assert [frame["step"] for frame in frames] == list(range(finished_run["steps"]))
    assert frames[0]["egos"][0]["id"] == "ego"


def test_a_range_includes_both_ends(http: httpx.Client, finished_run: dict[str, Any]) -> None:
    url = finished_run["observations_url"]
    answer = http.get(url, params={"first": 10, "last": 12})
    frames = [json.loads(line) for line in answer.text.splitlines()]
    whole = http.get(url).text.splitlines()
    assert [json.dumps(frame) for frame in frames] == [
        json.dumps(json.loads(line)) for line in whole[10:13]
    ]
    table = pq.read_table(
        io.BytesIO(http.get(url, params={"first": 10, "last": 12}, headers=PARQUET).content)
    )
    assert set(table.column("step").to_pylist()) == {10, 11, 12}


def test_parquet_is_the_recorded_file(http: httpx.Client, finished_run: dict[str, Any]) -> None:
    answer = http.get(finished_run["observations_url"], headers=PARQUET)
    table = pq.read_table(io.BytesIO(answer.content))
    assert table.column("step").to_pylist()[-1] == finished_run["steps"] - 1


def test_what_is_known_is_not_sent_again(http: httpx.Client, finished_run: dict[str, Any]) -> None:
    url = finished_run["observations_url"]
    etag = http.get(url, params={"last": 3}).headers["ETag"]
    known = {"If-None-Match": etag}
    assert http.get(url, params={"last": 3}, headers=known).status_code == 304
    assert http.get(url, params={"last": 4}, headers=known).status_code == 200


def test_other_forms_and_empty_ranges_are_refused(
    http: httpx.Client, finished_run: dict[str, Any]
) -> None:
    url = finished_run["observations_url"]
    assert http.get(url, headers={"Accept": "text/html"}).status_code == 406
    assert http.get(url, params={"first": 5, "last": 4}).status_code == 422
    assert http.get(url, params={"first": -1}).status_code == 422
    beyond = http.get(url, params={"first": 10**8})
    assert (beyond.status_code, beyond.text) == (200, "")


def test_an_id_is_never_a_path(http: httpx.Client) -> None:
    for bad in ("..%2F..%2Fetc%2Fpasswd", "%2e%2e", "a%00b", "x" * 5000):
        answer = http.get(f"/api/v1/runs/{bad}/observations")
        assert answer.status_code == 404, bad
        assert answer.headers["Content-Type"] == "application/problem+json"
