"""Campaign files: YAML or JSON that may name the file of its scenario."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal, TypeVar

from drivora_service.cli.scenarios.file_problems import read_or_exit
from drivora_service.cli.scenarios.scenario_files import describe_unreadable, read_files
from drivora_service.errors import ConfigurationError, InvalidDocument, Problem
from drivora_service.scenario.document_problems import in_document_order
from drivora_service.scenario.importers.reading import FileFormat, detect_format, read_scenarios
from drivora_service.scenario.plain_data import plain_data, refusal
from drivora_service.scenario.scenario_schema import schema_directory

_Answer = TypeVar("_Answer")


def shipped_campaigns() -> Path:
    """Returns the folder of the example campaigns, in a checkout or in an installed package."""
    return schema_directory() / "examples" / "campaigns"


def read_campaign_file(path: Path) -> dict[str, Any]:
    """Reads a campaign file and puts its scenario in place of the file that it names.

    Raises:
        ConfigurationError: The file cannot be read.
        InvalidDocument: It is no YAML or JSON, or its scenario cannot be read.
    """
    draft = read_campaign_draft(path)
    if draft.problems:
        raise InvalidDocument(draft.problems)
    return draft.content


@dataclass(frozen=True, slots=True, kw_only=True)
class CampaignDraft:
    """A campaign file as far as it can be read.

    Attributes:
        content: The document; it has no scenario if that could not be read.
        problems: What is wrong with the text of the file, and why its scenario could not be read.
        keys: The keys of the file in their order.
    """

    content: dict[str, Any]
    problems: tuple[Problem, ...]
    keys: tuple[str, ...]

    def with_problems(self, error: InvalidDocument) -> InvalidDocument:
        """Returns the problems of the file and those of its content, in the order of the file.

        Args:
            error: The problems of the content.
        """
        others = [
            problem
            for problem in error.problems
            # That the scenario is missing from the content is due to what is wrong with it.
            if not (self.problems and problem.pointer in ("", "/scenario", "/scenarios"))
        ]
        # The scenarios of a folder are those of the scenario in the file.
        order = {key: self.content.get(key, {}) for key in self.keys}
        return InvalidDocument(in_document_order((*self.problems, *others), order))


def read_campaign_draft(path: Path) -> CampaignDraft:
    """Reads a campaign file and puts its scenario in place of the file that it names.

    Raises:
        ConfigurationError: The file cannot be read.
        InvalidDocument: It is no YAML or JSON at all.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise ConfigurationError(describe_unreadable(path, error)) from error
    language: Literal["json", "yaml"] = "json" if path.suffix.lower() == ".json" else "yaml"
    content, problems = plain_data(data, language, what="a campaign")
    if problems and not content:
        raise InvalidDocument(tuple(problems))
    scenario = content.get("scenario")
    found, keys = list(problems), tuple(content)
    try:
        if isinstance(scenario, Mapping) and set(scenario) == {"file"}:
            content["scenario"] = _read_scenario(scenario["file"], path.parent)
        elif isinstance(scenario, Mapping) and set(scenario) == {"folder"}:
            del content["scenario"]
            content["scenarios"] = _read_scenarios(scenario["folder"], path.parent)
    except InvalidDocument as error:
        content.pop("scenario", None)
        found += error.problems
    return CampaignDraft(content=content, problems=tuple(found), keys=keys)


def send_campaign(path: Path, send: Callable[[dict[str, Any]], _Answer]) -> _Answer:
    """Sends a campaign file; prints every problem and ends the command if it has any.

    A file with problems of its own is sent as well, without the part that cannot be read: so the
    problems of its other parts are found, too, and it is never begun.

    Args:
        path: The file.
        send: Sends its content; raises ``InvalidDocument`` if it has problems.
    """

    def read_and_send() -> _Answer:
        draft = read_campaign_draft(path)
        try:
            return send(draft.content)
        except InvalidDocument as error:
            raise draft.with_problems(error) from error

    return read_or_exit(path, read_and_send)


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
        raise _refusal(describe_unreadable(path, error)) from error
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
