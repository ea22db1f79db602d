"""The OpenAPI document: an example for every operation, and the scenario's own schema."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi
from pydantic import TypeAdapter

from drivora_service.api import problem_details
from drivora_service.api.answers.arrow_answer import ARROW
from drivora_service.api.answers.recorded_frames import CSV, NDJSON, PARQUET
from drivora_service.api.answers.request_bodies import XML_TYPES
from drivora_service.api.answers.run_pictures import SVG
from drivora_service.api.documentation.operation_links import add_links
from drivora_service.api.documentation.recorded_examples import RECORDED, read_recorded
from drivora_service.api.guards.entity_tags import JSON
from drivora_service.api.schemas.batches import LabelledScenario
from drivora_service.api.schemas.events import Begin, Changes, Reset
from drivora_service.api.schemas.workers import Workers
from drivora_service.campaigns.document.campaign_documents import CampaignDocument
from drivora_service.scenario.documents import ScenarioDocument
from drivora_service.studies.study_documents import StudyDocument

_SCHEMAS = "#/components/schemas/"
_PACKED = "json:"
EVENTS = "text/event-stream"
"""Media type of a stream of events."""
PLAIN_TEXT = "text/plain"
"""Media type of an answer that is a line."""
_COLUMNS: Mapping[str, Any] = {
    "type": "object",
    "properties": {
        "rows": {"type": "integer", "description": "Number of rows."},
        "columns": {
            "type": "object",
            "description": "Values of each column, by its name.",
            "additionalProperties": {"type": "array", "items": {}},
        },
    },
    "required": ["rows", "columns"],
}
_BINARY: Mapping[str, Any] = {"schema": {"type": "string", "format": "binary"}}
_SCENARIO_REF = {"$ref": _SCHEMAS + "ScenarioDocument"}
_BATCH_ITEM: Mapping[str, Any] = {"oneOf": [_SCENARIO_REF, {"$ref": _SCHEMAS + "LabelledScenario"}]}
_DESCRIPTION = """Post scenarios and campaigns, follow them, fetch what was recorded and judged.

Every error is `application/problem+json` (RFC 9457); `problems` names each single thing that is
wrong with its JSON pointer. Lists come in pages: pass `next_page_token` as `page_token`. Answers
carry an `ETag`; a request with `If-None-Match` is answered with 304 where nothing changed.
"""


def answers(example: str, *errors: int, status: int = 200) -> dict[int | str, dict[str, Any]]:
    """Documents an operation: its answer with a recorded example, and the errors it can end in."""
    answer = {
        "description": "Done" if status < 202 else "Accepted",
        "content": {JSON: {"example": example}},
    }
    return _with_errors(answer, errors, status=status)


def no_content(*errors: int) -> dict[int | str, dict[str, Any]]:
    """Documents an operation without an answer, and the errors."""
    return _with_errors({"description": "Done"}, errors, status=204)


def problem_answer(status: int) -> dict[str, Any]:
    """Documents an error."""
    title, detail = _ERRORS[status]
    example = problem_details.ProblemDetails(title=title, status=status, detail=detail)
    return {
        "description": title,
        "content": {
            problem_details.MEDIA_TYPE: {
                "schema": {"$ref": _SCHEMAS + "ProblemDetails"},
                "example": _pack_example(example),
            }
        },
    }


def scenario_answers(example: str, *errors: int) -> dict[int | str, dict[str, Any]]:
    """Documents an answer that is one scenario, and the errors."""
    content = {JSON: {"schema": _SCENARIO_REF, "example": example}}
    return _with_errors({"description": "The scenario", "content": content}, errors)


def observations_answers(example: str, *errors: int) -> dict[int | str, dict[str, Any]]:
    """Documents an answer with the recording of a run, and the errors."""
    content = {
        NDJSON: {"schema": {"type": "string"}, "example": example},
        PARQUET: _BINARY,
        ARROW: _BINARY,
    }
    return _with_errors({"description": "One frame a step", "content": content}, errors)


def series_answers(example: str, *errors: int) -> dict[int | str, dict[str, Any]]:
    """Documents an answer as JSON with a recorded example, or as Arrow, and the errors."""
    content = {JSON: {"example": example}, ARROW: _BINARY}
    return _with_errors({"description": "Done", "content": content}, errors)


def table_answers(example: str, *errors: int) -> dict[int | str, dict[str, Any]]:
    """Documents an answer with a table, and the errors."""
    content = {
        CSV: {"schema": {"type": "string"}, "example": example},
        PARQUET: _BINARY,
        ARROW: _BINARY,
        JSON: {"schema": _COLUMNS, "example": {"rows": 2, "columns": {"evaluation": [0, 1]}}},
    }
    return _with_errors({"description": "The table", "content": content}, errors)


def event_answers(example: str, *errors: int) -> dict[int | str, dict[str, Any]]:
    """Documents an answer that is a stream of events, and the errors.

    The schema is that of the stream's text; ``x-events`` has those of the data by event.
    """
    data = {name: {"$ref": _SCHEMAS + kind.__name__} for name, kind in _EVENTS.items()}
    content = {EVENTS: {"schema": {"type": "string"}, "example": example, "x-events": data}}
    return _with_errors({"description": "The events", "content": content}, errors)


def id_answers(example: str, *errors: int) -> dict[int | str, dict[str, Any]]:
    """Documents an answer as JSON with a recorded example, or as a line with an id; the errors."""
    content = {
        JSON: {"example": example},
        PLAIN_TEXT: {"schema": {"type": "string"}, "example": "01a1fd17791a26704e9badf4\n"},
    }
    return _with_errors({"description": "Done", "content": content}, errors)


def picture_answers(example: str, *errors: int) -> dict[int | str, dict[str, Any]]:
    """Documents an answer with a picture, and the errors."""
    content = {SVG: {"schema": {"type": "string"}, "example": example}}
    return _with_errors({"description": "The picture", "content": content}, errors)


def scenario_body(example: Mapping[str, Any]) -> dict[str, Any]:
    """Documents a body that is one scenario."""
    content = {"schema": _SCENARIO_REF, "example": example}
    return {
        "requestBody": {
            "required": True,
            "content": {"application/json": content, "application/yaml": content},
        }
    }


def batch_body(example: Mapping[str, Any]) -> dict[str, Any]:
    """Documents a body that is many scenarios, at least one, with labels or without."""
    labelled = {"label": "crossing-17", "scenario": example}
    return {
        "requestBody": {
            "required": True,
            "content": {
                "application/json": {
                    "schema": {"type": "array", "minItems": 1, "items": _BATCH_ITEM},
                    "example": [labelled, example],
                },
                "application/x-ndjson": {"schema": _BATCH_ITEM, "example": labelled},
            },
        }
    }


def campaign_body(example: Mapping[str, Any]) -> dict[str, Any]:
    """Documents a body that is one campaign."""
    content = {"schema": {"$ref": _SCHEMAS + "CampaignDocument"}, "example": example}
    return {
        "requestBody": {
            "required": True,
            "content": {"application/json": content, "application/yaml": content},
        }
    }


def network_body(example: str) -> dict[str, Any]:
    """Documents a body that is the file of one road network."""
    content = {"schema": {"type": "string"}, "example": example}
    return {
        "requestBody": {
            "required": True,
            "content": dict.fromkeys(sorted(XML_TYPES), content),
        }
    }


def study_body(example: Mapping[str, Any]) -> dict[str, Any]:
    """Documents a body that is one study."""
    content = {"schema": {"$ref": _SCHEMAS + "StudyDocument"}, "example": example}
    return {
        "requestBody": {
            "required": True,
            "content": {"application/json": content, "application/yaml": content},
        }
    }


def install_openapi(
    api: FastAPI, *, tokens_needed: Callable[[], bool], root_path: str = ""
) -> None:
    """Replaces the application's ``openapi`` by one that returns the complete document.

    Args:
        api: With all its routes.
        tokens_needed: Returns whether this installation refuses requests without a token at the
            moment.
        root_path: Path that all paths are below; "": the root of the host.
    """
    built: dict[bool, dict[str, Any]] = {}

    def build() -> dict[str, Any]:
        needed = tokens_needed()
        if needed not in built:
            built[needed] = _build_document(api, tokens_needed=needed, root_path=root_path)
        return built[needed]

    api.openapi = build  # type: ignore[method-assign] # FastAPI's own way to extend the document


def _build_document(api: FastAPI, *, tokens_needed: bool, root_path: str) -> dict[str, Any]:
    document = get_openapi(
        title=api.title,
        version=api.version,
        description=_DESCRIPTION,
        routes=api.routes,
        servers=[{"url": root_path}] if root_path else None,
    )
    _unpack_examples(document["paths"])
    add_links(document["paths"])
    if not tokens_needed:
        _make_tokens_optional(document["paths"])
    schemas = document.setdefault("components", {}).setdefault("schemas", {})
    for model in (
        ScenarioDocument,
        CampaignDocument,
        StudyDocument,
        LabelledScenario,
        problem_details.ProblemDetails,
    ):
        schema = model.model_json_schema(ref_template=_SCHEMAS + "{model}")
        schemas.update(schema.pop("$defs", {}))
        schemas[model.__name__] = schema
    # The document is checked by the scenario room, so that its type is not in the model.
    schemas["LabelledScenario"]["properties"]["scenario"] = _SCENARIO_REF
    for kind in _EVENTS.values():
        schema = TypeAdapter(kind).json_schema(ref_template=_SCHEMAS + "{model}")
        schemas.update(schema.pop("$defs", {}))
        schemas[kind.__name__] = schema
    _simplify(document)
    return document


def _with_errors(
    answer: dict[str, Any], errors: Iterable[int], *, status: int = 200
) -> dict[int | str, dict[str, Any]]:
    return {status: answer, **{error: problem_answer(error) for error in errors}}


def _pack_example(example: problem_details.ProblemDetails) -> str:
    """Writes an example as text, for FastAPI would drop what is null in it."""
    return _PACKED + example.model_dump_json()


def _make_tokens_optional(paths: Mapping[str, Mapping[str, Any]]) -> None:
    for methods in paths.values():
        for operation in methods.values():
            if "security" in operation:
                operation["security"] = [{}, *operation["security"]]


def _simplify(part: Any) -> None:
    """Writes lists of a fixed length, and ids in paths, as every reader of schemas has them."""
    if isinstance(part, list):
        for item in part:
            _simplify(item)
        return
    if not isinstance(part, dict):
        return
    parts = part.get("prefixItems")
    if isinstance(parts, list) and parts and all(item == parts[0] for item in parts):
        part["items"] = part.pop("prefixItems")[0]
    if part.get("in") == "path" and part["schema"].get("type") == "string":
        part["schema"].update({"minLength": 1, "pattern": "^[^/:]+$"})
    if part.get("in") == "query":
        _say_that_text_has_no_nul(part["schema"])
    for value in part.values():
        _simplify(value)


def _say_that_text_has_no_nul(schema: dict[str, Any]) -> None:
    """Completes the schema of a query parameter by the refusals of ``query_guard``."""
    for alternative in (schema, *schema.get("anyOf", ())):
        text = alternative["items"] if alternative.get("type") == "array" else alternative
        if text.get("type") == "string" and "enum" not in text:
            text.setdefault("pattern", r"^[^\x00]*$")


def _unpack_examples(part: Any) -> None:
    """Replaces packed and recorded examples by their values, everywhere in a part."""
    if isinstance(part, list):
        for item in part:
            _unpack_examples(item)
    elif isinstance(part, dict):
        for key, value in part.items():
            if key == "example" and isinstance(value, str) and value.startswith(_PACKED):
                part[key] = json.loads(value.removeprefix(_PACKED))
            elif key == "example" and isinstance(value, str) and value.startswith(RECORDED):
                part[key] = read_recorded(value)
            else:
                _unpack_examples(value)


_EVENTS: Mapping[str, type] = {
    "begin": Begin,
    "changes": Changes,
    "reset": Reset,
    "workers": Workers,
}
_ERRORS: Mapping[int, tuple[str, str]] = {
    401: ("Unauthorized", "an API token is needed: Authorization: Bearer …"),
    403: ("Forbidden", "token 'viewer' has scope read; submit is needed"),
    404: ("Not Found", "unknown run '0'"),
    406: ("Not Acceptable", "observations come as application/x-ndjson or Parquet"),
    409: ("Conflict", "the first request with this Idempotency-Key is still being done"),
    413: ("Request Entity Too Large", "the body is larger than the bytes that are allowed"),
    415: ("Unsupported Media Type", "the body must be plain application/json"),
    422: ("Unprocessable Entity", "1 problem in the document"),
    429: ("Too Many Requests", "the queue is full; try again later"),
    503: (
        "Service Unavailable",
        "nothing can be stored now: database: the database cannot be used now: database is locked",
    ),
}
