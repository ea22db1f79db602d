"""``start_from`` of campaign and study files, and ``--start-from``."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer
from pydantic import ValidationError

from drivora_service.campaigns.document.campaign_documents import (
    CampaignDocument,
)
from drivora_service.campaigns.document.start_documents import MAX_STARTS, StartKind
from drivora_service.cli.campaigns.start_choosing import (
    Scene,
    StartChoice,
    find_earlier,
    start_of,
)
from drivora_service.cli.terminal.options import parse_choice
from drivora_service.errors import InvalidDocument, Problem

if TYPE_CHECKING:
    from drivora_service.client import Client

_KEYS = ("campaign", "folder")
_OPTIONS = ("with", "most")
_POINTER = "/tester/start_from"


def start_option(source: str, kind: str, most: int | None) -> StartChoice | None:
    """Reads ``--start-from``, ``--start-with`` and ``--start-most``; ``None`` without the first.

    Raises:
        typer.BadParameter: A value is not allowed, or the first is missing.
    """
    if not source:
        for option, given in (("--start-with", bool(kind)), ("--start-most", most is not None)):
            if given:
                raise typer.BadParameter("needs --start-from", param_hint=option)
        return None
    choice = StartChoice(
        source=source,
        folder=Path(),
        kind=parse_choice(StartKind, kind or StartKind.FAILURES, "--start-with"),
    )
    return choice if most is None else replace(choice, most=most)


def resolve_campaign_start(
    client: Client, content: dict[str, Any], folder: Path, option: StartChoice | None = None
) -> dict[str, Any]:
    """Puts the genes of candidates in place of the campaign or folder that has them.

    Args:
        client: Client of the application or service that has the earlier campaign.
        content: The campaign, perhaps not valid.
        folder: Folder of its file.
        option: What the user chose on the command line, in place of the file.

    Raises:
        ConfigurationError: There is no such campaign or folder, or it has other scenes.
        InvalidDocument: ``start_from`` is not valid.
    """
    tester = content.get("tester")
    if not isinstance(tester, Mapping):
        return content
    choice = option or read_choice(tester.get("start_from"), folder, _POINTER)
    if choice is None:
        return content
    cold = {**content, "tester": {k: v for k, v in tester.items() if k != "start_from"}}
    try:
        document = CampaignDocument.model_validate_json(json.dumps(cold))
    except (ValidationError, ValueError):
        # The service names all problems together.
        client.validate_campaign(json.dumps(cold))
        raise _other_version() from None
    earlier = find_earlier(client, choice)
    scenes = {
        name: Scene(scenario=scenario, space=document.space)
        for name, scenario in document.seeds.items()
    }
    start = start_of(earlier, choice, scenes)
    return {**cold, "tester": {**cold["tester"], "start_from": start}}


def resolve_study_starts(client: Client, content: dict[str, Any], folder: Path) -> dict[str, Any]:
    """Puts the genes of candidates in place of the campaigns or folders that have them.

    Args:
        client: Client of the application or service that has the earlier campaigns.
        content: The study, perhaps not valid.
        folder: Folder of its file.

    Raises:
        ConfigurationError: There is no such campaign or folder, or it has other scenes.
        InvalidDocument: ``start_from`` is not valid.
    """
    # Imported here: campaigns need no studies.
    from drivora_service.studies.study_documents import StudyDocument

    methods = content.get("methods")
    if not isinstance(methods, list):
        return content
    choices = [
        read_choice(one.get("start_from"), folder, f"/methods/{place}/start_from")
        if isinstance(one, Mapping)
        else None
        for place, one in enumerate(methods)
    ]
    if not any(choices):
        return content
    cold = {
        **content,
        "methods": [
            method
            if choice is None
            else {k: v for k, v in method.items() if k != "start_from"}
            | {"label": method.get("label") or f"{method.get('name')} from {choice.kind}"}
            for method, choice in zip(methods, choices, strict=True)
        ],
    }
    try:
        document = StudyDocument.model_validate_json(json.dumps(cold))
    except (ValidationError, ValueError):
        client.validate_study(json.dumps(cold))
        raise _other_version() from None
    scenes = {
        label: Scene(scenario=one.document, space=one.space or document.space)
        for label, one in zip(document.scenario_labels, document.scenarios, strict=True)
    }
    for place, choice in enumerate(choices):
        if choice is not None:
            start = start_of(find_earlier(client, choice), choice, scenes)
            # Each campaign has one scene, and the hash is that of all scenes together.
            if len({scene.scenario.map_region.town for scene in scenes.values()}) > 1:
                start.pop("network_sha256", None)
            cold["methods"][place] = {**cold["methods"][place], "start_from": start}
    return cold


def read_choice(given: object, folder: Path, pointer: str) -> StartChoice | None:
    """Reads a ``start_from`` that names a campaign or a folder; ``None`` of any other.

    Raises:
        InvalidDocument: It is not valid.
    """
    if not isinstance(given, Mapping) or not any(key in given for key in _KEYS):
        return None
    problems = [
        Problem(
            pointer=f"{pointer}/{key}",
            code="unknown_key",
            message=f"found a key that is not known; allowed: {', '.join((*_KEYS, *_OPTIONS))}",
        )
        for key in given
        if key not in (*_KEYS, *_OPTIONS)
    ]
    key = "folder" if "folder" in given else "campaign"
    if all(one in given for one in _KEYS):
        problems.append(_problem(pointer, "found both `campaign` and `folder`; give one"))
    if not isinstance(source := given[key], str) or not source:
        problems.append(_problem(f"{pointer}/{key}", "found no text; a name or path is needed"))
    kind = given.get("with", StartKind.FAILURES)
    if kind not in list(StartKind):
        allowed = " or ".join(StartKind)
        problems.append(_problem(f"{pointer}/with", f"found {kind!r}; allowed: {allowed}"))
    most = given.get("most")
    if most is not None and (type(most) is not int or not 1 <= most <= MAX_STARTS):
        message = f"found {most!r}; allowed: a whole number from 1 to {MAX_STARTS}"
        problems.append(_problem(f"{pointer}/most", message))
    if problems:
        raise InvalidDocument(tuple(problems))
    choice = StartChoice(
        source=str(source), folder=folder, kind=StartKind(kind), is_folder=key == "folder"
    )
    return choice if most is None else replace(choice, most=most)


def _problem(pointer: str, message: str) -> Problem:
    return Problem(pointer=pointer, code="start_source", message=message)


def _other_version() -> InvalidDocument:
    message = (
        "the service reads this file in another way than this command: use the command of the "
        "version of the service"
    )
    return InvalidDocument((Problem(pointer="", code="other_version", message=message),))
