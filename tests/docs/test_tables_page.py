"""The reference page of the tables lists the columns that the files have: all, and no others."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from drivora_service.studies.table_names import ResultTableName
from drivora_service.studies.tables.result_table_columns import COLUMNS, result_schema

_PAGE = (Path(__file__).resolve().parents[2] / "docs" / "reference" / "tables.md").read_text()


def _listed(name: ResultTableName) -> list[tuple[str, ...]]:
    section = _PAGE.split(f"\n## {name}\n", 1)[1].split("\n## ", 1)[0]
    lines = re.findall(r"^\| (.*) \|$", section, re.MULTILINE)
    head, *rows = (tuple(cell.strip() for cell in line.split("|")) for line in lines)
    assert head == ("column", "type", "unit", "null", "meaning")
    return rows


@pytest.mark.parametrize("name", ResultTableName)
def test_the_page_and_the_schema_agree(name: ResultTableName) -> None:
    fields = [
        (
            f"`{field.name}`",
            str(field.type),
            field.metadata.get(b"unit", b"").decode(),
            "yes" if field.nullable else "",
            field.metadata[b"meaning"].decode(),
        )
        for field in result_schema(name)
    ]
    assert _listed(name) == fields
    assert [column.name for column in COLUMNS[name]] == [name.strip("`") for name, *_ in fields]


def test_the_page_has_every_table() -> None:
    headings = re.findall(r"^## (\w+)$", _PAGE, re.MULTILINE)
    assert [heading for heading in headings if heading.islower()] == [*ResultTableName]
