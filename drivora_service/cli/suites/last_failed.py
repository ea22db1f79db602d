"""The scenarios of a suite that failed the last time, kept in the current folder."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Collection
from pathlib import Path

from drivora_service.cli.terminal.output import note
from drivora_service.errors import ConfigurationError

_FOLDER = ".drivora"
"""Beside the user's files, as the caches of other test runners are."""


def remember_failed(suite: Path, names: Collection[str], *, not_run: Collection[str]) -> None:
    """Keeps which scenarios of a suite failed.

    Args:
        suite: Path of the suite.
        names: Those that failed.
        not_run: Those that were not run, which stay as they were.
    """
    path = _path(suite)
    try:
        before = set(_read(path)) & set(not_run)
        path.parent.mkdir(parents=True, exist_ok=True)
        (path.parents[1] / ".gitignore").write_text("*\n")
        # Whole or not at all, also where the command is killed.
        partial = path.with_name(f".{path.name}.{os.getpid()}.part")
        partial.write_text(json.dumps(sorted(before | set(names)), indent=1) + "\n")
        partial.replace(path)
    except (OSError, ConfigurationError) as error:
        note(f"note: {path} cannot be written, so that --last-failed will not know: {error}")


def read_last_failed(suite: Path, scenarios: Collection[str]) -> frozenset[str]:
    """Returns the scenarios that failed the last time.

    Args:
        suite: Path of the suite.
        scenarios: Names of the scenarios that it has.

    Raises:
        ConfigurationError: The suite was not run from this folder, or nothing failed.
    """
    path = _path(suite)
    if not path.is_file():
        raise ConfigurationError(
            f"--last-failed: {suite} was not run from this folder before; run it without "
            "--last-failed first"
        )
    names = frozenset(_read(path)) & frozenset(scenarios)
    if not names:
        raise ConfigurationError(
            f"--last-failed: no scenario of {suite} failed the last time; run it without "
            "--last-failed"
        )
    return names


def _path(suite: Path) -> Path:
    # Suites of the same name in different folders are different.
    digest = hashlib.sha256(str(suite.resolve()).encode()).hexdigest()[:12]
    return Path(_FOLDER) / "last-failed" / f"{digest}.json"


def _read(path: Path) -> list[str]:
    if not path.is_file():
        return []
    try:
        content = json.loads(path.read_bytes())
    except ValueError as error:
        raise ConfigurationError(f"{path} is damaged; delete it") from error
    if not isinstance(content, list) or not all(isinstance(name, str) for name in content):
        raise ConfigurationError(f"{path} is damaged; delete it")
    return content
