"""Files of Drivora that are no scenarios, recognised by their keys."""

from __future__ import annotations

import json
import re
import shlex
from collections.abc import Set
from dataclasses import dataclass
from pathlib import Path

NO_SCENARIO = "no_scenario"
"""Code of the problem of such a file."""

_TOP_KEY = re.compile(r"^([A-Za-z_$][\w$]*):(?=\s|$)", re.MULTILINE)
"""A key of the outermost object of block-style YAML."""
_MOST_BYTES = 4 * 1024 * 1024
_SCENARIO = frozenset({"ego_vehicles", "map_region"})


@dataclass(frozen=True, slots=True, kw_only=True)
class _Kind:
    """A kind of files.

    Attributes:
        words: What such a file is.
        keys: It has all of these keys.
        any_of: If there are any, it has one of these, too.
        command: What reads it; ``{}`` stands for its path.
    """

    words: str
    keys: Set[str] = frozenset()
    any_of: Set[str] = frozenset()
    command: str


_KINDS = (
    _Kind(
        words="a campaign file",
        keys={"tester", "budget"},
        any_of={"scenario", "scenarios"},
        command="drivora campaign run {}",
    ),
    _Kind(
        words="a study file",
        keys={"methods"},
        any_of={"scenarios", "agents", "budget"},
        command="drivora study run {}",
    ),
    _Kind(
        words="a baseline",
        keys={"suite", "versions", "scenarios"},
        any_of={"counts"},
        command="drivora suite run SUITE --baseline {}",
    ),
    _Kind(
        words="a file of results of a suite",
        keys={"suite", "size", "runs"},
        command="drivora suite gate SUITE {}",
    ),
    _Kind(words="a suite file", keys={"name", "scenarios"}, command="drivora suite run {}"),
    _Kind(
        words="a gate file",
        any_of={"fail_on", "limits", "metrics", "confirm", "unfinished", "overall"},
        command="drivora suite run SUITE --gate-file {}",
    ),
    _Kind(words="a file of traffic laws", keys={"laws"}, command="drivora laws check {}"),
    _Kind(
        words="the manifest of an ADS",
        keys={"name", "kind"},
        any_of={"command", "address"},
        command="drivora agents list",
    ),
    _Kind(words="a list of cases", keys={"cases"}, command=""),
    _Kind(words="a JSON schema", keys={"$schema"}, command=""),
)
"""In this order: a study and a baseline have the keys of a suite, too."""


def describe_other_file(path: Path) -> str:
    """Returns what a file is, and which command reads it; "" for a scenario or an unknown file."""
    keys = _top_keys(path)
    if keys & _SCENARIO:
        return ""
    for kind in _KINDS:
        if kind.keys <= keys and (not kind.any_of or kind.any_of & keys):
            command = kind.command.format(shlex.quote(str(path)))
            return f"is {kind.words}" + (f": {command}" if command else ", not a scenario")
    return ""


def _top_keys(path: Path) -> frozenset[str]:
    """Returns the keys of the outermost object of a file, as far as they can be read."""
    try:
        if path.stat().st_size > _MOST_BYTES:
            return frozenset()
        text = path.read_text()
        if text.lstrip().startswith("{"):
            content = json.loads(text)
            return frozenset(content) if isinstance(content, dict) else frozenset()
    except (OSError, ValueError, RecursionError):
        return frozenset()
    return frozenset(_TOP_KEY.findall(text))
