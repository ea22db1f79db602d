"""Campaign files: YAML or JSON that may name the file of its scenario."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

from drivora_service.errors import ConfigurationError, InvalidDocument, Problem
from drivora_service.scenario.importers.reading import FileFormat, detect_format, read_scenarios
from drivora_service.scenario.plain_data import plain_data, refusal


def shipped_campaigns() -> Path:
    """Returns the folder of the example campaigns, in a checkout or in an installed package."""
    package = Path(__file__).resolve().parents[1]
    installed = package / "_data" / "openscenario_schemas"
    schemas = installed if installed.is_dir() else package.parent / "openscenario_schemas"
    return schemas / "examples" / "campaigns"


def read_campaign_file(path: Path) -> dict[str, Any]:
    """Reads a campaign file and puts its scenario in place of the file that it names.

    Raises:
        ConfigurationError: The file cannot be read.
        InvalidDocument: It is no YAML or JSON, or its scenario cannot be read.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise ConfigurationError(f"{path} cannot be read: {error.strerror}") from error
    language: Literal["json", "yaml"] = "json" if path.suffix.lower() == ".json" else "yaml"
    content, problems = plain_data(data, language, what="a campaign")
    if problems:
        raise InvalidDocument(tuple(problems))
    scenario = content.get("scenario")
    if isinstance(scenario, Mapping) and set(scenario) == {"file"}:
        content["scenario"] = _scenario_of(scenario["file"], path.parent)
    return content


def _scenario_of(name: object, folder: Path) -> dict[str, Any]:
    if not isinstance(name, str) or not name:
        raise _refusal("found no file name; a path relative to the campaign file is needed")
    path = folder / name
    try:
        data = path.read_bytes()
    except OSError as error:
        raise _refusal(f"{path} cannot be read: {error.strerror}") from error
    try:
        return _content(data, path)
    except InvalidDocument as error:
        raise InvalidDocument(
            tuple(replace(p, pointer=f"/scenario{p.pointer}") for p in error.problems)
        ) from error


def _content(data: bytes, path: Path) -> dict[str, Any]:
    language = detect_format(data)
    if language in (FileFormat.JSON, FileFormat.YAML):
        # Unchecked: reading the campaign names the problems of both together.
        content, problems = plain_data(data, "json" if language is FileFormat.JSON else "yaml")
        if problems:
            raise InvalidDocument(tuple(problems))
        return content
    found = read_scenarios(data, name=path.stem)
    if len(found) != 1:
        message = f"{path} holds {len(found)} scenarios; a campaign begins with one"
        raise refusal("scenario_file", message)
    return found[0].document.model_dump(mode="json", exclude_defaults=True, exclude_none=True)


def _refusal(message: str) -> InvalidDocument:
    return InvalidDocument(
        (Problem(pointer="/scenario/file", code="scenario_file", message=message),)
    )
