"""Campaign files: YAML or JSON that may name the file of its scenario."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

from drivora_service.cli.scenarios.scenario_files import read_files
from drivora_service.errors import ConfigurationError, InvalidDocument, Problem
from drivora_service.scenario.importers.reading import FileFormat, detect_format, read_scenarios
from drivora_service.scenario.plain_data import plain_data, refusal
from drivora_service.scenario.scenario_schema import schema_directory


def shipped_campaigns() -> Path:
    """Returns the folder of the example campaigns, in a checkout or in an installed package."""
    return schema_directory() / "examples" / "campaigns"


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
        content["scenario"] = _read_scenario(scenario["file"], path.parent)
    elif isinstance(scenario, Mapping) and set(scenario) == {"folder"}:
        del content["scenario"]
        content["scenarios"] = _read_scenarios(scenario["folder"], path.parent)
    return content


def _read_scenarios(name: object, folder: Path) -> list[dict[str, Any]]:
    """Reads all scenarios of a folder, in order of name."""
    if not isinstance(name, str) or not name:
        raise _refusal("found no name; a path relative to the campaign file is needed", "folder")
    path = folder / name
    if not path.is_dir():
        raise _refusal(f"there is no folder {path}", "folder")
    try:
        scenarios, unreadable = read_files([path], agent="")
    except ConfigurationError as error:
        raise _refusal(str(error), "folder") from error
    if unreadable:
        raise InvalidDocument(
            tuple(
                replace(
                    problem, pointer="/scenario/folder", message=f"{one.path}: {problem.message}"
                )
                for one in unreadable
                for problem in one.problems
            )
        )
    return [
        {
            "name": one.name,
            "scenario": one.document.model_dump(
                mode="json", exclude_defaults=True, exclude_none=True
            ),
        }
        for one in scenarios
    ]


def _read_scenario(name: object, folder: Path) -> dict[str, Any]:
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


def _refusal(message: str, key: str = "file") -> InvalidDocument:
    return InvalidDocument(
        (Problem(pointer=f"/scenario/{key}", code="scenario_file", message=message),)
    )
