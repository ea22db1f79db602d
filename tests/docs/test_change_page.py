"""The page of common changes names files that exist, or folders for new ones."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

_ROOT = Path(__file__).resolve().parents[2]
_PAGE = (_ROOT / "docs" / "how-to" / "change-drivora.md").read_text(encoding="utf-8")
_SECTIONS = dict(re.findall(r"^## (Add [^\n]*)\n(.*?)(?=^## |\Z)", _PAGE, re.DOTALL | re.MULTILINE))
_MOST_OF_A_FIELD = 6
"""Files that a field of a job may take."""


def _files(section: str) -> list[str]:
    """Returns the files in the first columns of the tables of a section."""
    rows = re.findall(r"^\| (`.*?) \|", _SECTIONS[section], re.MULTILINE)
    return [file for row in rows for file in re.findall(r"`([^`]+)`", row)]


@pytest.mark.parametrize("section", _SECTIONS)
def test_the_files_of_a_change_exist(section: str) -> None:
    files = _files(section)
    assert files
    for file in files:
        folder, is_new, _ = file.partition("<")
        place = folder.rpartition("/")[0] if is_new else file
        assert (_ROOT / place).exists(), file


@pytest.mark.parametrize("section", _SECTIONS)
def test_the_files_that_the_text_names_exist(section: str) -> None:
    named = re.findall(r"`((?:drivora_service|docs|tests)/[a-z_/.]+)`", _SECTIONS[section])
    assert [file for file in named if not (_ROOT / file).exists()] == []


def test_the_page_names_targets_that_exist() -> None:
    targets = set(re.findall(r"^([a-z-]+):", (_ROOT / "Makefile").read_text(), re.MULTILINE))
    named = set(re.findall(r"`make ([a-z-]+)`", _PAGE))
    assert named
    assert named <= targets


def test_a_field_of_a_job_takes_few_files() -> None:
    assert len(_files("Add a field of a job")) <= _MOST_OF_A_FIELD
