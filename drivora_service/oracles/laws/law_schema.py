"""The JSON Schema of law files, generated from the pydantic models."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from drivora_service.oracles.laws.law_documents import LawFileDocument
from drivora_service.scenario.scenario_schema import schema_directory

VERSION = "1.0"
_FILE = f"laws-{VERSION}.schema.json"
_EXAMPLE: dict[str, Any] = {
    "version": VERSION,
    "laws": [
        {
            "name": "keep_two_seconds",
            "title": "Two seconds of distance",
            "source": "Rule of thumb of driving schools",
            "description": "The ego follows a vehicle at less than two seconds for long.",
            "parameters": {
                "gap": {"value": 2.0, "unit": "s", "meaning": "The time that is kept."},
                "patience": {"value": 3.0, "unit": "s", "meaning": "A shorter time is excused."},
            },
            "formula": "always (eventually[0:patience] (leader_gap >= gap * speed))",
        }
    ],
}


def schema_path() -> Path:
    """The committed schema file."""
    return schema_directory() / _FILE


def shipped_laws() -> Path:
    """Returns the folder of the shipped laws, in a checkout or in an installed package."""
    return schema_directory() / "laws"


def laws_schema() -> dict[str, Any]:
    """Returns the schema (JSON Schema, draft 2020-12)."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": f"urn:drivora:laws:{VERSION}",
        **LawFileDocument.model_json_schema(),
        "title": f"Law file {VERSION}",
        "examples": [_EXAMPLE],
    }


def schema_text() -> str:
    """Returns the text of the schema file."""
    return json.dumps(laws_schema(), indent=2, ensure_ascii=False) + "\n"
