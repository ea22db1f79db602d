from __future__ import annotations

import io
import json
import subprocess
from typing import Any

import httpx
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

PARQUET = {"Accept": "application/vnd.apache.parquet"}
ARROW = {"Accept": "application/vnd.apache.arrow.stream", "Accept-Encoding": "identity"}


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


def test_arrow_has_the_columns_of_the_recorded_file(
    http: httpx.Client, finished_run: dict[str, Any]
) -> None:
    url = finished_run["observations_url"]
    answer = http.get(url, headers=ARROW)
    assert answer.headers["Content-Type"] == ARROW["Accept"]
    stream = pa.ipc.open_stream(answer.content).read_all()
    file = pq.read_table(io.BytesIO(http.get(url, headers=PARQUET).content))
    assert stream.column("x").to_pylist() == file.column("x").to_pylist()
    part: dict[str, Any] = {"first": 10, "last": 12, "rows": "egos", "column": ["x", "yaw"]}
    some = pa.ipc.open_stream(http.get(url, params=part, headers=ARROW).content).read_all()
    assert some.to_pydict() == {
        "step": [10, 11, 12],
        "actor": [0, 0, 0],
        "x": stream.column("x").to_pylist()[10:13],
        "yaw": stream.column("yaw").to_pylist()[10:13],
    }


@pytest.mark.parametrize(("coding", "program"), [("gzip", "gzip"), ("zstd", "")])
def test_arrow_is_compressed_as_the_client_accepts(
    http: httpx.Client, finished_run: dict[str, Any], coding: str, program: str
) -> None:
    url = finished_run["observations_url"]
    plain = http.get(url, headers=ARROW)
    with http.stream("GET", url, headers={**ARROW, "Accept-Encoding": coding}) as answer:
        sent = b"".join(answer.iter_raw())
    assert answer.headers["Content-Encoding"] == coding
    assert "Accept-Encoding" in answer.headers["Vary"]
    assert answer.headers["ETag"] != plain.headers["ETag"]
    assert len(sent) < 0.7 * len(plain.content)
    if program:
        found = subprocess.run([program, "-dc"], input=sent, capture_output=True, check=True).stdout
    else:
        found = pa.CompressedInputStream(pa.BufferReader(sent), coding).read()
    assert found == plain.content


def test_columns_and_rows_that_cannot_be_chosen_are_refused(
    http: httpx.Client, finished_run: dict[str, Any]
) -> None:
    url = finished_run["observations_url"]
    unknown = http.get(url, params={"column": "colour"}, headers=ARROW)
    assert unknown.status_code == 404
    assert "known: step, time, actor, x" in unknown.json()["detail"]
    assert http.get(url, params={"rows": "walkers"}, headers=ARROW).status_code == 422
    for params in ({"column": "x"}, {"rows": "egos"}):
        assert http.get(url, params=params, headers=PARQUET).status_code == 406


def test_chosen_columns_and_rows_come_as_arrow_unless_the_client_says_otherwise(
    http: httpx.Client, finished_run: dict[str, Any]
) -> None:
    url = finished_run["observations_url"]
    for params in ({"column": "x"}, {"rows": "egos"}):
        answer = http.get(url, params=params)
        assert (answer.status_code, answer.headers["Content-Type"]) == (200, ARROW["Accept"])


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
