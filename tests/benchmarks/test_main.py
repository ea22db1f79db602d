from __future__ import annotations

from pathlib import Path

import pytest

from benchmarks.__main__ import main
from benchmarks.suite.page import page
from benchmarks.suite.result import read_result, write_result
from tests.benchmarks.suite.results import result, series


def test_two_results_are_compared(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    one, other = tmp_path / "one.json", tmp_path / "other.json"
    write_result(result(series("run", 1.0, 1.1)), one)
    write_result(result(series("run", 2.0, 2.1)), other)
    assert main(["compare", str(one), str(other)]) == 0
    assert "1 quantities: 1 worse." in capsys.readouterr().out


def test_a_file_that_is_no_result_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "one.json"
    path.write_text("{}")
    assert main(["compare", str(path), str(path)]) == 2
    assert "is not a result of `python -m benchmarks`" in capsys.readouterr().err


def test_a_page_is_written_from_a_result(tmp_path: Path) -> None:
    path = tmp_path / "one.json"
    write_result(result(series("run", 1.0, 1.1)), path)
    assert main(["page", str(path), "--out", str(tmp_path / "page.md")]) == 0
    assert (tmp_path / "page.md").read_text() == page(read_result(path))


@pytest.mark.slow(seconds=20)
def test_a_measurement_writes_its_result(tmp_path: Path) -> None:
    out = tmp_path / "result.json"
    assert main(["--short", "--rounds", "1", "--only", "step-cost", "--out", str(out)]) == 0
    measured = read_result(out)
    assert [section.name for section in measured.sections] == ["step-cost"]
    values = {(s.quantity.case, s.quantity.name): s.median for s in measured.sections[0].series}
    assert 0.0 < values["11 actors", "step"] < values["51 actors", "step"]
