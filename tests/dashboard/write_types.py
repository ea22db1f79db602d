"""Writes the types of the API for the page: ``make page-types``.

The description of the API comes from the application itself, without its examples; the generator
is a package of the page's sources.
"""

from __future__ import annotations

import json
import subprocess
import tempfile
from pathlib import Path
from typing import Any

from drivora_service.app import create_app
from drivora_service.dashboard.build import node_program
from drivora_service.settings import Settings

WEB = Path(__file__).parents[2] / "drivora_service" / "dashboard" / "web"
TYPES = WEB / "src" / "api" / "schema.d.ts"
GENERATOR = WEB / "node_modules" / "openapi-typescript" / "bin" / "cli.js"


def description() -> dict[str, Any]:
    """Returns the description of the API that the page is written against."""
    with tempfile.TemporaryDirectory() as folder:
        found = create_app(Settings(data_dir=Path(folder))).openapi()
    return {name: _without_examples(part) for name, part in found.items()}


def write_types(path: Path = TYPES) -> None:
    """Writes the types into a file."""
    with tempfile.TemporaryDirectory() as folder:
        document = Path(folder) / "openapi.json"
        document.write_text(json.dumps(description(), sort_keys=True))
        subprocess.run(
            [str(node_program()), str(GENERATOR), str(document), "--output", str(path)],
            check=True,
            stdout=subprocess.DEVNULL,
        )


def _without_examples(value: Any, *, names: bool = False) -> Any:
    """Returns a description without examples; the keys of `properties` are names, and all stay."""
    if isinstance(value, dict):
        return {
            key: _without_examples(item, names=key == "properties" and not names)
            for key, item in value.items()
            if names or key not in ("example", "examples") or not isinstance(item, (list, dict))
        }
    if isinstance(value, list):
        return [_without_examples(item) for item in value]
    return value


if __name__ == "__main__":
    write_types()
