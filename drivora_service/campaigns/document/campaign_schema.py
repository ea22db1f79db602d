"""The JSON Schema of campaign files, generated from the pydantic models."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from drivora_service.campaigns.document.campaign_documents import CampaignDocument
from drivora_service.campaigns.document.start_documents import MAX_STARTS, StartKind
from drivora_service.scenario.scenario_schema import schema_directory

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


def _place(key: str, description: str) -> dict[str, Any]:
    return {
        "type": "object",
        "description": f"{description}; only the command line reads files.",
        "properties": {
            key: {
                "type": "string",
                "minLength": 1,
                "description": "Path relative to the campaign's file.",
            }
        },
        "required": [key],
        "additionalProperties": False,
    }


def add_start_sources(tester: dict[str, Any]) -> None:
    """Adds to the schema of a tester that its first candidates may be named by their campaign."""
    start = tester["properties"]["start_from"]
    start["anyOf"] += [
        {
            "type": "object",
            "description": f"{what}; only the command line looks it up.",
            "properties": {
                key: {"type": "string", "minLength": 1, "description": f"{what}."},
                "with": {
                    "enum": [str(kind) for kind in StartKind],
                    "default": str(StartKind.FAILURES),
                    "description": "Which of its candidates.",
                },
                "most": {
                    "type": "integer",
                    "minimum": 1,
                    "maximum": MAX_STARTS,
                    "description": "Candidates of each seed scenario, at most [default: 20].",
                },
            },
            "required": [key],
            "additionalProperties": False,
        }
        for key, what in (
            (
                "campaign",
                "Id or name of an earlier campaign on the same scenario and space, or latest",
            ),
            ("folder", "Folder that an earlier campaign was written to, relative to this file"),
        )
    ]


def schema_path() -> Path:
    """The committed schema file."""
    return schema_directory() / _FILE


def campaign_schema() -> dict[str, Any]:
    """Returns the schema (JSON Schema, draft 2020-12) of a file, which may name its scenario's."""
    schema = CampaignDocument.model_json_schema()
    properties = schema["properties"]
    for key in ("scenario", "scenarios"):
        given, _null = properties[key].pop("anyOf")
        properties[key] = {"description": properties[key]["description"], **given}
    scenario = properties["scenario"]
    properties["scenario"] = {
        "description": scenario.pop("description"),
        "anyOf": [
            scenario,
            _place("file", "The scenario's file"),
            _place("folder", "The folder of several seed scenarios, which take turns"),
        ],
    }
    properties["scenarios"]["minItems"] = 1
    add_start_sources(schema["$defs"]["TesterDocument"])
    schema["oneOf"] = [{"required": ["scenario"]}, {"required": ["scenarios"]}]
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
