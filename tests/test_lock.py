"""The pinned packages: one version of each, whatever the version of Python."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path

import pytest

REQUIREMENTS = Path(__file__).parents[1] / "requirements"
LOCKS = sorted(path.stem for path in REQUIREMENTS.glob("*.txt"))


def pinned(lock: str) -> list[tuple[str, str]]:
    """The names and versions of a lock."""
    text = (REQUIREMENTS / f"{lock}.txt").read_text()
    return re.findall(r"^([\w.-]+)(?:\[[\w,-]+\])?==(\S+)", text, re.M)


@pytest.mark.parametrize("lock", LOCKS)
def test_every_version_of_python_has_the_same_packages(lock: str) -> None:
    """If it fails: bound the package in ``requirements/bounds.in``."""
    versions = Counter(name for name, _version in pinned(lock))
    assert versions
    assert [name for name, count in versions.items() if count > 1] == []


@pytest.mark.parametrize("lock", LOCKS)
def test_what_is_shipped_is_what_is_tested(lock: str) -> None:
    tested = dict(pinned("dev"))
    others = {name: version for name, version in pinned(lock) if tested.get(name) != version}
    assert others == {}


@pytest.mark.parametrize("lock", LOCKS)
def test_a_lock_names_no_address(lock: str) -> None:
    assert "//" not in (REQUIREMENTS / f"{lock}.txt").read_text()
