"""The JSON Schemas of suite files and gate files, generated from the pydantic models."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from drivora_service.scenario.scenario_schema import schema_directory
from drivora_service.suites.gate.gate_documents import GateDocument
from drivora_service.suites.suite_documents import SuiteDocument

VERSION = "1.0"
_DIALECT = "https://json-schema.org/draft/2020-12/schema"
_EXAMPLE: dict[str, Any] = {
    "name": "crossings",
    "repetitions": 3,
    "scenarios": [
        "scenarios/*.json",
        {
            "file": "found/left-turn.json",
            "name": "left turn before a lorry",
            "tags": ["left-turn"],
            "oracles": ["collision", "red_light"],
            "metrics": {"driving_score": {"at_least": 60.0}},
            "known_failures": [{"oracle": "collision", "agents": ["idm"], "reason": "issue 17"}],
        },
    ],
}
_GATE_EXAMPLE: dict[str, Any] = {
    "fail_on": ["new", "worse"],
    "limits": [
        {"oracles": ["collision"], "accountability": ["avoidable"], "most_scenarios": 0},
        {"severity": ["critical", "major"], "most_share": 0.05},
    ],
    "metrics": [{"metric": "driving_score", "at_least": 70.0, "most_drop": 2.0}],
}
_PATH: dict[str, Any] = {
    "type": "string",
    "minLength": 1,
    "description": "A file, a folder (all scenario files in it) or a pattern such as "
    "scenarios/*.json, relative to the suite's file.",
}


def suite_schema_path() -> Path:
    """The committed schema file of suites."""
    return schema_directory() / f"suite-{VERSION}.schema.json"


def gate_schema_path() -> Path:
    """The committed schema file of gates."""
    return schema_directory() / f"gate-{VERSION}.schema.json"


def suite_schema() -> dict[str, Any]:
    """Returns the schema (JSON Schema, draft 2020-12) of a suite file."""
    schema = SuiteDocument.model_json_schema()
    scenarios = schema["properties"]["scenarios"]
    inside = schema["$defs"]["SuiteScenarioDocument"]["properties"]
    of_file = {
        "type": "object",
        "description": "Scenario files.",
        "properties": {
            "file": _PATH,
            **{key: value for key, value in inside.items() if key != "document"},
        },
        "required": ["file"],
        "additionalProperties": False,
    }
    scenarios["items"] = {"anyOf": [scenarios["items"], of_file, _PATH]}
    return {
        "$schema": _DIALECT,
        "$id": f"urn:drivora:suite:{VERSION}",
        **schema,
        "title": f"Suite {VERSION}",
        "examples": [_EXAMPLE],
    }


def gate_schema() -> dict[str, Any]:
    """Returns the schema (JSON Schema, draft 2020-12) of a gate file."""
    return {
        "$schema": _DIALECT,
        "$id": f"urn:drivora:gate:{VERSION}",
        **GateDocument.model_json_schema(),
        "title": f"Gate {VERSION}",
        "examples": [_GATE_EXAMPLE],
    }


def suite_schema_text() -> str:
    """Returns the text of the schema file of suites."""
    return _text(suite_schema())


def gate_schema_text() -> str:
    """Returns the text of the schema file of gates."""
    return _text(gate_schema())


def _text(schema: dict[str, Any]) -> str:
    return json.dumps(schema, indent=2, ensure_ascii=False) + "\n"
