"""Common parts of several harnesses: the checkout, its catalogues, a folder, and documents.

Catalogues are imported when they are needed: a session instruments all that it imports.
"""

from __future__ import annotations

import os
import tempfile
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from drivora_service.errors import InvalidDocument
from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.scenario.plain_data import plain_data
from tests.fuzzing.harness import check_refusal

if TYPE_CHECKING:
    from drivora_service.agents.catalogue import AgentCatalogue
    from drivora_service.campaigns.document.campaign_catalogues import Catalogues

REPOSITORY = Path(__file__).resolve().parents[3]


@cache
def networks() -> NetworkCatalogue:
    """The shipped networks."""
    return NetworkCatalogue(REPOSITORY / "sumo_nets")


@cache
def catalogues() -> Catalogues:
    """Returns the catalogues of campaigns."""
    from drivora_service.campaigns.document.campaign_catalogues import Catalogues

    return Catalogues(networks())


@cache
def agents() -> AgentCatalogue:
    """The agents that scenarios may name."""
    from drivora_service.agents.catalogue import AgentCatalogue

    return AgentCatalogue()


@cache
def folder() -> Path:
    """A folder of this process, gone when it ends."""
    # In memory where that can be: networks are files, thousands of them.
    memory = Path("/dev/shm")
    inside = memory if os.access(memory, os.W_OK) else None
    directory = tempfile.TemporaryDirectory(prefix="drivora-fuzzing-", dir=inside)
    _kept.append(directory)
    return Path(directory.name)


_kept: list[tempfile.TemporaryDirectory[str]] = []
"""Removed when the process ends; a directory that nothing holds is removed at once."""


def check_problems(error: InvalidDocument, data: bytes, language: Literal["json", "yaml"]) -> None:
    """Checks a refusal of a text, the places in it included."""
    named = any(problem.pointer for problem in error.problems)
    check_refusal(error, _content_of(data, language) if named else None)


def _content_of(data: bytes, language: Literal["json", "yaml"]) -> Any:
    """Returns a document as plain data, to look places up in; ``None`` where it is none."""
    try:
        return plain_data(data, language)[0]
    except InvalidDocument:
        return None


def example_scenarios() -> dict[str, bytes]:
    """Returns the shipped scenarios."""
    folder = REPOSITORY / "openscenario_schemas" / "examples"
    return {path.stem: path.read_bytes() for path in sorted(folder.glob("*.json"))}
