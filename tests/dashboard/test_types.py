"""The page is compiled against the API as it is."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.dashboard.write_types import GENERATOR, TYPES, write_types


def test_the_types_are_those_of_the_api(tmp_path: Path) -> None:
    if not GENERATOR.is_file():
        pytest.skip("the page's tools are not installed: make page-tools")
    write_types(tmp_path / "schema.d.ts")
    now = (tmp_path / "schema.d.ts").read_text()
    assert now == TYPES.read_text(), "the API has changed: make page-types"
