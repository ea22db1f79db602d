"""The user's law files, read once for a service or command and all its workers.

Apart from their meaning, so that processes that only hand them on do not load what judges.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

SUFFIXES = (".yaml", ".yml")
"""Suffixes of law files."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LawSource:
    """The text of a law file.

    Attributes:
        file: Name of the file.
        data: Its bytes; empty if it cannot be read.
        fault: Why it cannot be read, or "".
    """

    file: str
    data: bytes = field(repr=False)
    fault: str = ""


def read_law_source(path: Path) -> LawSource:
    """Reads a law file."""
    try:
        return LawSource(file=path.name, data=path.read_bytes())
    except OSError as error:
        return LawSource(file=path.name, data=b"", fault=f"cannot be read: {error}")


def read_law_sources(folder: Path | None) -> tuple[LawSource, ...]:
    """Reads the law files of a folder in the order of their names; none if it does not exist."""
    if folder is None or not folder.is_dir():
        return ()
    return tuple(
        read_law_source(path)
        for path in sorted(folder.iterdir())
        if path.suffix in SUFFIXES and not path.name.startswith(".")
    )
