"""Modules and files of the package that pages and docstrings name exist."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.docs.test_links import PAGES

_ROOT = Path(__file__).resolve().parents[2]
_PACKAGE = _ROOT / "drivora_service"
_ROOMS = sorted(path.parent.name for path in _PACKAGE.glob("*/__init__.py"))
_PATH = re.compile(r"(?<![\w.-])drivora_service((?:[./]\w+)+)")
_IN_A_ROOM = re.compile(rf"`((?:{'|'.join(_ROOMS)})(?:[./]\w+)+)`")
_ENTRY_POINTS = frozenset(
    re.findall(
        r'group="drivora_service\.(\w+)"',
        "".join(path.read_text() for path in _PACKAGE.rglob("*.py")),
    )
)


def _paths(text: str) -> Iterator[str]:
    for pattern in (_PATH, _IN_A_ROOM):
        for match in pattern.finditer(text):
            yield match[1].lstrip("./")


def _exists(path: str) -> bool:
    """Returns whether a path is a file, a folder, a module, a name in a module, or a group."""
    if (_PACKAGE / path).exists() or path in _ENTRY_POINTS:
        return True
    place, parts = _PACKAGE, path.split(".")
    for number, part in enumerate(parts):
        module = place / f"{part}.py"
        if module.is_file():
            names = parts[number + 1 :]
            return not names or re.search(rf"\b{names[0]}\b", module.read_text()) is not None
        place /= part
    return place.is_dir()


def _prose(source: Path) -> str:
    nodes = ast.walk(ast.parse(source.read_text()))
    texts = (node.value for node in nodes if isinstance(node, ast.Constant))
    return "\n".join(text for text in texts if isinstance(text, str) and "``" in text)


@pytest.mark.parametrize("page", PAGES)
def test_modules_in_pages_exist(page: str) -> None:
    found = set(_paths((_ROOT / page).read_text()))
    assert [path for path in sorted(found) if not _exists(path)] == []


@pytest.mark.parametrize("room", [*_ROOMS, "."])
def test_modules_in_docstrings_exist(room: str) -> None:
    pattern = "*.py" if room == "." else f"{room}/**/*.py"
    missing = {
        f"{source.relative_to(_ROOT)}: {path}"
        for source in _PACKAGE.glob(pattern)
        for path in _paths(_prose(source))
        if not _exists(path)
    }
    assert sorted(missing) == []


@pytest.mark.parametrize(
    ("path", "expected"),
    [
        ("worker.loop", True),
        ("worker.loop.Perform", True),
        ("execution.worker", False),
        ("campaigns.failures", False),
        ("agents/remote/agent.proto", True),
        ("agents/environments", False),
        ("testers", True),
    ],
)
def test_moved_modules_are_found(path: str, expected: bool) -> None:
    assert _exists(path) is expected
