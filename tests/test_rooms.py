"""The rooms of the package are those that CONTRIBUTING describes, and stay easy to look through."""

from __future__ import annotations

import ast
import re
import tomllib
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

_ROOT = Path(__file__).resolve().parents[1]
_PACKAGE = _ROOT / "drivora_service"
_GUIDE = (_ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
_MOST_MODULES = 25
# Beside the rooms: the contracts for authors of plug-ins, and data that only a wheel has.
_BESIDE = frozenset({"testing", "_data", "__init__"})

# The parts of one ADS or one method, and the resources of the API, are named alike on purpose.
_PARALLEL = re.compile(
    r"agents/\w+/|search/testers/\w+/|api/routes/|api/schemas/|client/calls/|store/migrations/"
)
# Rooms that take plug-ins have public modules of these names.
_SHARED_NAMES = frozenset({"catalogue", "plugin"})


def _modules() -> Iterator[Path]:
    for path in sorted(_PACKAGE.rglob("*.py")):
        if path.stem not in {"__init__", "__main__"} and "node_modules" not in path.parts:
            yield path.relative_to(_PACKAGE)


def _map_of_rooms() -> list[set[str]]:
    """Returns the rooms of each line of the map, from the top down."""
    block = re.search(r"^```\n(cli .*?)^```$", _GUIDE, re.DOTALL | re.MULTILINE)
    assert block is not None
    lines = [line for line in block[1].splitlines() if not line.startswith(" ")]
    return [set(re.split(r"\s{2,}", line)[0].split(" | ")) for line in lines]


def _folders() -> dict[str, str]:
    """Returns what each folder inside a room holds, by its path."""
    found: dict[str, str] = {}
    for init in sorted(_PACKAGE.glob("*/**/__init__.py")):
        folder = init.parent.relative_to(_PACKAGE)
        path = folder.as_posix()
        one_plugin = re.match(
            r"agents/(?!(adapters|imitation|raster|remote)$)|search/testers/", path
        )
        if len(folder.parts) > 1 and not one_plugin and path != "store/migrations/versions":
            docstring = ast.get_docstring(ast.parse(init.read_text(encoding="utf-8")))
            assert docstring, f"{path} does not say what it holds"
            found[path] = docstring.splitlines()[0].replace("``", "`")
    return found


def test_the_map_is_that_of_the_import_contracts() -> None:
    contracts = tomllib.loads((_ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]
    layers = contracts["contracts"][0]["layers"]
    assert _map_of_rooms() == [set(layer.split(" | ")) for layer in layers]


def test_every_room_is_on_the_map() -> None:
    rooms = {path.stem for path in _PACKAGE.glob("*.py")}
    rooms |= {path.parent.name for path in _PACKAGE.glob("*/__init__.py")}
    assert set().union(*_map_of_rooms()) == rooms - _BESIDE


def test_every_folder_is_described() -> None:
    described = dict(re.findall(r"^\| `([\w/]+/\w+)` \| (.+) \|$", _GUIDE, re.MULTILINE))
    assert described == _folders()


def test_no_folder_is_a_long_list() -> None:
    counts: defaultdict[str, int] = defaultdict(int)
    for module in _modules():
        if "versions" not in module.parts:
            counts[module.parent.as_posix()] += 1
    assert {folder: count for folder, count in counts.items() if count > _MOST_MODULES} == {}


def test_a_module_is_found_by_its_name() -> None:
    places: defaultdict[str, list[str]] = defaultdict(list)
    for module in _modules():
        path = module.as_posix()
        if not _PARALLEL.match(path) and module.stem not in _SHARED_NAMES:
            places[module.stem].append(path)
    assert {name: found for name, found in places.items() if len(found) > 1} == {}
