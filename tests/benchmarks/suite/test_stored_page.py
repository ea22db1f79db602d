"""The page of the documentation is that of the stored result."""

from __future__ import annotations

from pathlib import Path

from benchmarks.suite.measurements import MEASUREMENTS
from benchmarks.suite.page import page
from benchmarks.suite.result import read_result


def test_the_page_is_that_of_the_stored_result(repository: Path) -> None:
    stored = read_result(repository / "benchmarks" / "results" / "benchmarks.json")
    assert not stored.short
    assert {section.name for section in stored.sections} <= {one.name for one in MEASUREMENTS}
    written = (repository / "docs" / "reference" / "benchmarks.md").read_text()
    assert written == page(stored)
