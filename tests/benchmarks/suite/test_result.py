from __future__ import annotations

import json
from pathlib import Path

import jsonschema
import pytest

from benchmarks.suite.result import ADAPTER, ResultError, read_result, write_result
from tests.benchmarks.suite.results import result, series


def test_a_result_is_read_as_it_was_written(tmp_path: Path) -> None:
    written = result(series("run", 1.0, 1.5, unit="ms"), remarks=("nothing.",))
    write_result(written, tmp_path / "folder" / "result.json")
    assert read_result(tmp_path / "folder" / "result.json") == written


def test_the_file_follows_the_schema(tmp_path: Path) -> None:
    write_result(result(series("run", 1.0)), tmp_path / "result.json")
    content = json.loads((tmp_path / "result.json").read_text())
    schema = ADAPTER.json_schema()
    jsonschema.validate(content, schema)
    assert content["schema"] == 1
    del content["machine"]["nice"]
    with pytest.raises(jsonschema.ValidationError, match="'nice' is a required property"):
        jsonschema.validate(content, schema)


def test_the_values_of_a_series_are_summed_up() -> None:
    one = series("run", 3.0, 1.0, 8.0)
    assert (one.median, one.low, one.high) == (3.0, 1.0, 8.0)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"schema": 2}, "schema: Input should be 1"),
        ({"sections": 3}, "sections: Input should be a valid array"),
        ({"machine": {}}, r"machine\.cpu: Field required"),
    ],
)
def test_other_files_are_refused(tmp_path: Path, change: dict[str, object], message: str) -> None:
    path = tmp_path / "result.json"
    write_result(result(series("run", 1.0)), path)
    path.write_text(json.dumps({**json.loads(path.read_text()), **change}))
    with pytest.raises(ResultError, match=message):
        read_result(path)


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(ResultError, match=r"none\.json: No such file"):
        read_result(tmp_path / "none.json")
