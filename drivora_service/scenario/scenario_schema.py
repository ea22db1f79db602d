"""The JSON Schema of the OpenScenario document, generated from the pydantic models."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from drivora_service.scenario.documents import ScenarioDocument

VERSION = "1.0"
_FILE = f"openscenario-{VERSION}.schema.json"
_EXAMPLE: dict[str, Any] = {
    "version": VERSION,
    "frame": "sumo",
    "map_region": {"town": "tee-town"},
    "ego_vehicles": [
        {
            "id": "ego_0",
            "model": "vehicle.lincoln.mkz_2017",
            "route": [{"x": 100.0, "y": 152.1}, {"x": 30.0, "y": 153.2}],
            "agent": {"name": "idm"},
        }
    ],
    "weather": {"precipitation": 60.0, "wetness": 80.0},
    "seed": 1,
}


def schema_directory() -> Path:
    """Returns the folder of the schema and the examples, in a checkout or an installed package."""
    package = Path(__file__).resolve().parents[1]
    installed = package / "_data" / "openscenario_schemas"
    return installed if installed.is_dir() else package.parent / "openscenario_schemas"


def schema_path() -> Path:
    """Returns the path of the committed schema file."""
    return schema_directory() / _FILE


def document_schema() -> dict[str, Any]:
    """Returns the schema (JSON Schema, draft 2020-12); ``x-unit`` is the unit of a number."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": f"urn:drivora:openscenario:{VERSION}",
        **ScenarioDocument.model_json_schema(),
        "title": f"OpenScenario document {VERSION}",
        "examples": [_EXAMPLE],
    }


def schema_text() -> str:
    """Returns the text of the schema file."""
    return json.dumps(document_schema(), indent=2, ensure_ascii=False) + "\n"
