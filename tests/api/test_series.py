from __future__ import annotations

import json
from typing import Any

import httpx
import numpy as np
import pyarrow as pa

ARROW = {"Accept": "application/vnd.apache.arrow.stream"}


def test_both_forms_have_the_same_values(http: httpx.Client, finished_run: dict[str, Any]) -> None:
    url = f"/api/v1/runs/{finished_run['id']}/series"
    series = http.get(url).json()
    stream = pa.ipc.open_stream(http.get(url, headers=ARROW).content)
    table = stream.read_all()
    head = json.loads(table.schema.metadata[b"drivora_series"])
    assert head == {key: value for key, value in series.items() if key != "values"}
    assert table.column_names == [column["name"] for column in series["columns"]]
    assert table.num_rows == finished_run["steps"]
    for name, values in series["values"].items():
        read = np.array(values, dtype=np.float64)
        np.testing.assert_allclose(table.column(name).to_numpy(), read, atol=1e-6)
    assert series["ego"] == "ego"
    lanes = {str(index) for index in series["values"]["lane"] if index >= 0}
    assert lanes == set(series["lanes"])


def test_the_least_time_to_collision_is_the_metric(
    http: httpx.Client, finished_run: dict[str, Any]
) -> None:
    values = http.get(f"/api/v1/runs/{finished_run['id']}/series").json()["values"]
    times = [value for value in values["time_to_collision"] if value is not None]
    assert finished_run["metrics"]["min_time_to_collision_s"] == (min(times) if times else None)
    assert max(values["speed"]) <= 13.9 * 1.05


def test_what_is_not_there_is_refused(http: httpx.Client, finished_run: dict[str, Any]) -> None:
    url = f"/api/v1/runs/{finished_run['id']}/series"
    unknown = http.get(url, params={"ego": 7})
    assert unknown.status_code == 404
    assert "known: 0" in unknown.json()["detail"]
    assert http.get(url, params={"ego": -1}).status_code == 422
    assert http.get(url, headers={"Accept": "text/html"}).status_code == 406
    for headers in ({}, ARROW):
        etag = http.get(url, headers=headers).headers["ETag"]
        known = {**headers, "If-None-Match": etag}
        assert http.get(url, headers=known).status_code == 304
        assert http.get(url, params={"ego": 1}, headers=known).status_code == 404
