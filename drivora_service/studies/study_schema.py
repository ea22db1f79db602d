"""The JSON Schema of study files, generated from the pydantic models."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from drivora_service.campaigns.document.campaign_schema import add_start_sources
from drivora_service.scenario.scenario_schema import schema_directory
from drivora_service.studies.study_documents import StudyDocument

VERSION = "1.0"
_FILE = f"study-{VERSION}.schema.json"
_EXAMPLE: dict[str, Any] = {
    "name": "two methods",
    "scenarios": ["seeds", {"file": "crossing.json", "space": {"vehicles": 5}}],
    "agents": [{"name": "idm"}, {"name": "idm-mobil"}],
    "methods": [
        {"name": "random"},
        {"name": "avfuzzer", "parameters": {"population": 6}, "label": "avfuzzer, 6"},
    ],
    "repetitions": 20,
    "space": {"vehicles": 3, "walkers": 1},
    "budget": {"simulations": 200},
}
_PATH: dict[str, Any] = {
    "type": "string",
    "minLength": 1,
    "description": "A file, a folder (all scenario files in it) or a pattern such as "
    "seeds/tee-*.json, relative to the study's file; only the command line reads files.",
}


def schema_path() -> Path:
    """The committed schema file."""
    return schema_directory() / _FILE


def study_schema() -> dict[str, Any]:
    """Returns the schema (JSON Schema, draft 2020-12) of a file, which may name scenario files."""
    schema = StudyDocument.model_json_schema()
    add_start_sources(schema["$defs"]["StudyMethodDocument"])
    scenarios = schema["properties"]["scenarios"]
    inside = schema["$defs"]["StudyScenarioDocument"]["properties"]
    of_file = {
        "type": "object",
        "description": "Scenario files.",
        "properties": {"file": _PATH, "label": inside["label"], "space": inside["space"]},
        "required": ["file"],
        "additionalProperties": False,
    }
    scenarios["items"] = {"anyOf": [scenarios["items"], of_file, _PATH]}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": f"urn:drivora:study:{VERSION}",
        **schema,
        "title": f"Study {VERSION}",
        "examples": [_EXAMPLE],
    }


def schema_text() -> str:
    """Returns the text of the schema file."""
    return json.dumps(study_schema(), indent=2, ensure_ascii=False) + "\n"
