"""Checkpoints of a campaign's tester, as files in the campaign's folder."""

from __future__ import annotations

import contextlib
import re
from pathlib import Path

_NAME = re.compile(r"(\d{8})\.checkpoint")
_KEPT = 2
"""Number of checkpoints that are kept: the latest may be of evaluations that a kill has lost."""


class FolderCheckpoints:
    """Checkpoints as files that are written as a whole or not at all."""

    def __init__(self, folder: Path, told: int) -> None:
        """Takes a folder, which need not exist.

        Args:
            folder: Folder of the files.
            told: Number of evaluations that are stored, and will be told again.
        """
        self._folder, self._told = folder, told

    def last(self) -> tuple[int, bytes] | None:
        """Returns the latest checkpoint of stored evaluations that can be read."""
        for number, path in reversed(self._files()):
            if number <= self._told:
                with contextlib.suppress(OSError):
                    return number, path.read_bytes()
        return None

    def save(self, told: int, state: bytes) -> None:
        """Keeps the state after ``told`` evaluations, and removes all but the one before.

        A disk that is full or missing costs the checkpoint, not the campaign.
        """
        with contextlib.suppress(OSError):
            self._folder.mkdir(parents=True, exist_ok=True)
            path = self._folder / f"{told:08d}.checkpoint"
            unfinished = path.with_suffix(".unfinished")
            unfinished.write_bytes(state)
            unfinished.replace(path)
            for _, old in self._files()[:-_KEPT]:
                old.unlink(missing_ok=True)

    def _files(self) -> list[tuple[int, Path]]:
        if not self._folder.is_dir():
            return []
        matches = ((_NAME.fullmatch(path.name), path) for path in self._folder.iterdir())
        return sorted((int(match[1]), path) for match, path in matches if match)
