"""The JSON Schema of campaign files, generated from the pydantic models."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from drivora_service.campaigns.documents import CampaignDocument
from drivora_service.scenario.schema import schema_directory

VERSION = "1.0"
_FILE = f"campaign-{VERSION}.schema.json"
_EXAMPLE: dict[str, Any] = {
    "name": "crossing, random",
    "tester": {"name": "random"},
    "agent": {"name": "idm"},
    "scenario": {"file": "crossing.json"},
    "space": {"vehicles": 3, "walkers": 1},
    "budget": {"simulations": 200},
    "oracles": ["collision", "red_light"],
    "seed": 1,
}
_SCENARIO_FILE: dict[str, Any] = {
    "type": "object",
    "description": "The scenario's file; only the command line reads files.",
    "properties": {
        "file": {
            "type": "string",
            "minLength": 1,
            "description": "Path relative to the campaign's file.",
        }
    },
    "required": ["file"],
    "additionalProperties": False,
}


def schema_path() -> Path:
    """The committed schema file."""
    return schema_directory() / _FILE


def campaign_schema() -> dict[str, Any]:
    """Returns the schema (JSON Schema, draft 2020-12) of a file, which may name its scenario's."""
    schema = CampaignDocument.model_json_schema()
    scenario = schema["properties"]["scenario"]
    schema["properties"]["scenario"] = {
        "description": scenario.pop("description"),
        "anyOf": [scenario, _SCENARIO_FILE],
    }
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": f"urn:drivora:campaign:{VERSION}",
        **schema,
        "title": f"Campaign {VERSION}",
        "examples": [_EXAMPLE],
    }


def schema_text() -> str:
    """Returns the text of the schema file."""
    return json.dumps(campaign_schema(), indent=2, ensure_ascii=False) + "\n"
