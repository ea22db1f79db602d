"""The manifest of an ADS with its own process: ``agent.yaml``."""

from __future__ import annotations

import keyword
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator
from pydantic_core import PydanticCustomError

from drivora_service.agents.entry import AgentKind
from drivora_service.agents.manifest_parameters import ManifestParameter, ParameterDocument
from drivora_service.errors import AgentError, InvalidDocument, Problem
from drivora_service.given_names import CHECKED_NAME, CHECKED_NOTE
from drivora_service.scenario.document_problems import structural_problems
from drivora_service.scenario.fields import NAME_PATTERN
from drivora_service.scenario.plain_data import plain_data

_PLACEHOLDER = re.compile(r"\{(\w+)\}")
_PLACEHOLDERS = ("python", "folder")
_SETTING = r"^DRIVORA_[A-Z0-9_]+$"
_ADDRESS = r"^(unix:/.+|\[?[A-Za-z0-9_.:-]+\]?:[0-9]{1,5})$"

_Text = Annotated[str, Field(strict=True, min_length=1, max_length=2000)]
_Version = Annotated[str, Field(strict=True, min_length=1, max_length=200), CHECKED_NAME]
_Shown = Annotated[str, Field(strict=True, min_length=1, max_length=2000), CHECKED_NOTE]
_Variable = Annotated[str, Field(strict=True, pattern=r"^[^=]+$", max_length=2000)]
_ParameterName = Annotated[str, Field(strict=True, pattern=r"^[A-Za-z][A-Za-z0-9_]{0,63}$")]
_Seconds = Annotated[float, Field(gt=0, le=3600, allow_inf_nan=False)]


@dataclass(frozen=True, slots=True, kw_only=True)
class AgentDeadlines:
    """Limits of an ADS in seconds of wall time.

    Attributes:
        start: From the start of its process until it answers ``Describe``.
        setup: For ``SetupEnv``.
        step: For ``RunStep``.
    """

    start: float = 60.0
    setup: float = 30.0
    step: float = 5.0


@dataclass(frozen=True, slots=True, kw_only=True)
class AgentManifest:
    """The operator's description of an ADS.

    Attributes:
        folder: Folder of the manifest.
        version: Version of the ADS, "" if unknown.
        command: Command that starts it, with placeholders; empty if it runs elsewhere.
        variables: Its environment variables.
        settings: Names of the operator's environment variables for it, among those that begin with
            ``DRIVORA_`` and are otherwise withheld from ADSs, since they may be secret.
        address: Address of an ADS that runs elsewhere, else "".
        environment: Name of its virtual environment, which agents may share.
        resolved: Whether its requirements are complete, so that the packages' own requirements of
            other packages and of Python are ignored.
        deadlines: Its deadlines.
        parameters: Parameters that documents may set; ``None``: known to the ADS only.
    """

    name: str
    kind: AgentKind
    description: str
    source: str
    licence: str
    folder: Path
    version: str = ""
    command: tuple[str, ...] = ()
    variables: tuple[tuple[str, str], ...] = ()
    settings: tuple[str, ...] = ()
    address: str = ""
    environment: str = ""
    resolved: bool = False
    deadlines: AgentDeadlines = AgentDeadlines()
    parameters: tuple[ManifestParameter, ...] | None = None


class _Deadlines(BaseModel):
    model_config = ConfigDict(extra="forbid")

    start: _Seconds = Field(
        default=AgentDeadlines().start,
        description="From the start of the process until it answers Describe, seconds.",
    )
    setup: _Seconds = Field(default=AgentDeadlines().setup, description="For SetupEnv, seconds.")
    step: _Seconds = Field(default=AgentDeadlines().step, description="For RunStep, seconds.")


class _Manifest(BaseModel):
    model_config = ConfigDict(extra="forbid")

    name: Annotated[str, Field(strict=True, pattern=NAME_PATTERN)]
    kind: AgentKind
    description: _Shown
    source: _Shown
    licence: _Shown
    version: (
        Annotated[str, Field(strict=True, min_length=1, max_length=200), CHECKED_NAME] | None
    ) = None
    command: tuple[_Text, ...] = ()
    variables: dict[_Variable, Annotated[str, Field(strict=True)]] = {}
    settings: tuple[Annotated[str, Field(strict=True, pattern=_SETTING)], ...] = ()
    address: Annotated[str, Field(strict=True, pattern=_ADDRESS)] | None = None
    environment: Annotated[str, Field(strict=True, pattern=NAME_PATTERN)] | None = None
    resolved: Annotated[bool, Field(strict=True)] = False
    deadlines: _Deadlines = _Deadlines()
    parameters: dict[_ParameterName, ParameterDocument] | None = None

    @model_validator(mode="after")
    def _one_way_to_reach_it(self) -> Self:
        if bool(self.command) == (self.address is not None):
            found = "both" if self.command else "neither"
            raise PydanticCustomError(
                "command_or_address",
                "found {found} of command and address; give the one that starts it, or the one "
                "where it listens",
                {"found": found},
            )
        return self


def read_manifest(path: Path, name: str) -> AgentManifest:
    """Reads the manifest of the agent ``name``.

    Raises:
        AgentError: With all problems and their places.
    """
    try:
        text = path.read_bytes()
    except OSError as error:
        raise _unusable(path, f"it cannot be read: {error.strerror}") from error
    try:
        return _manifest(text, path, name)
    except InvalidDocument as error:
        lines = "; ".join(f"{p.pointer or '/'}: {p.message}" for p in error.problems)
        raise _unusable(path, lines) from error


def _manifest(text: bytes, path: Path, name: str) -> AgentManifest:
    content, odd = plain_data(text, "yaml", what="a manifest")
    problems = list(odd)
    try:
        document = _Manifest.model_validate(content)
    except ValidationError as error:
        known = {problem.pointer for problem in odd}
        structural = structural_problems(error, _Manifest, content)
        problems += [problem for problem in structural if problem.pointer not in known]
        raise InvalidDocument(tuple(problems)) from error
    problems += _problems(document, name)
    if problems:
        raise InvalidDocument(tuple(problems))
    return AgentManifest(
        name=document.name,
        kind=document.kind,
        description=document.description,
        source=document.source,
        licence=document.licence,
        version=document.version or "",
        folder=path.parent.resolve(),
        command=document.command,
        variables=tuple(document.variables.items()),
        settings=document.settings,
        address=document.address or "",
        environment=document.environment or document.name,
        resolved=document.resolved,
        deadlines=AgentDeadlines(**document.deadlines.model_dump()),
        parameters=None
        if document.parameters is None
        else tuple(parameter.parameter(name) for name, parameter in document.parameters.items()),
    )


def _problems(document: _Manifest, name: str) -> list[Problem]:
    problems = []
    if document.name != name:
        message = f"found {document.name!r}; a manifest is called like its folder: {name!r}"
        problems.append(Problem(pointer="/name", code="name", message=message))
    for index, word in enumerate(document.command):
        for found in _PLACEHOLDER.findall(word):
            if found not in _PLACEHOLDERS:
                allowed = ", ".join(f"{{{known}}}" for known in _PLACEHOLDERS)
                message = f"found {{{found}}}; allowed: {allowed}"
                problems.append(
                    Problem(pointer=f"/command/{index}", code="placeholder", message=message)
                )
    problems += [
        Problem(
            pointer=f"/variables/{variable}",
            code="variable",
            message="found a variable of Drivora's own; allowed: any that does not begin with "
            "DRIVORA_",
        )
        for variable in document.variables
        if variable.startswith("DRIVORA_")
    ]
    problems += [
        Problem(
            pointer=f"/parameters/{parameter}",
            code="parameter_name",
            message=f"found {parameter!r}, a word of Python's; allowed: any other name",
        )
        for parameter in document.parameters or ()
        if keyword.iskeyword(parameter)
    ]
    return problems


def command_line(manifest: AgentManifest, python: Path) -> list[str]:
    """Returns the command with its placeholders filled in."""
    values: Mapping[str, str] = {"python": str(python), "folder": str(manifest.folder)}
    return [_PLACEHOLDER.sub(lambda match: values[match[1]], word) for word in manifest.command]


def _unusable(path: Path, why: str) -> AgentError:
    return AgentError(f"{path} cannot be used: {why}", cause="agent_manifest")
