"""Reads a scenario file of any known format."""

from __future__ import annotations

from enum import StrEnum

from drivora_service.scenario.documents import parse_document
from drivora_service.scenario.importers.imported import ImportedScenario, short_name
from drivora_service.scenario.importers.leaderboard import import_routes
from drivora_service.scenario.importers.original_tool import import_original, is_original
from drivora_service.scenario.plain_data import MAX_DOCUMENT_BYTES, decode_text, plain_data


class FileFormat(StrEnum):
    """Formats of scenario files."""

    JSON = "json"
    """The OpenScenario document as JSON."""
    YAML = "yaml"
    """The OpenScenario document as YAML."""
    ORIGINAL_TOOL = "original-tool"
    """JSON of the original, CARLA-based tool."""
    LEADERBOARD = "leaderboard"
    """XML routes of the CARLA Leaderboard."""


def detect_format(data: str | bytes) -> FileFormat:
    """Detects the format of a file from its content.

    Raises:
        InvalidDocument: The file is too large, not UTF-8, or neither XML nor readable JSON or YAML.
    """
    text = decode_text(data, MAX_DOCUMENT_BYTES).lstrip()
    if text.startswith("<"):
        return FileFormat.LEADERBOARD
    language = FileFormat.JSON if text.startswith(("{", "[")) else FileFormat.YAML
    content, _ = plain_data(text, "json" if language is FileFormat.JSON else "yaml")
    return FileFormat.ORIGINAL_TOOL if is_original(content) else language


def read_scenarios(
    data: str | bytes, *, name: str, agent: str = "idm"
) -> tuple[ImportedScenario, ...]:
    """Reads all scenarios of a file of any format.

    Args:
        data: Content of the file.
        name: Name of a scenario without one, such as the file's stem.
        agent: Agent for the egos of formats that name no agent of the catalogue.

    Raises:
        InvalidDocument: Every problem of the file.
    """
    found = detect_format(data)
    if found is FileFormat.LEADERBOARD:
        return import_routes(data, agent=agent)
    if found is FileFormat.ORIGINAL_TOOL:
        return (import_original(data, agent=agent),)
    document = parse_document(data, "yaml" if found is FileFormat.YAML else "json")
    return (ImportedScenario(name=short_name(name, "scenario"), document=document, notes=()),)
