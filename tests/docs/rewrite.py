"""Runs the commands of pages and writes what they print into the pages: ``make docs-numbers``.

Usage: ``python -m tests.docs.rewrite [PAGE…]``; without pages, those whose numbers are compared
digit by digit. Pictures that the commands draw and the page shows are written anew as well. Lines
whose words have changed are left, and found by the tests.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from tests.docs.blocks import commands_of, renewed_lines
from tests.docs.test_commands import WITH_EXACT_NUMBERS, run_page

_ROOT = Path(__file__).resolve().parents[2]


def rewrite(page: Path) -> bool:
    """Renews a page and the pictures that its commands draw; returns whether its text changed."""
    before = text = page.read_text()
    commands = commands_of(text)
    with tempfile.TemporaryDirectory() as folder:
        outputs = [printed for _, printed in run_page(commands, Path(folder))]
        for made in sorted((Path(folder) / "checkout").iterdir()):
            picture = _ROOT / "docs" / "images" / made.name
            if picture.is_file() and f"docs/images/{made.name}" in text:
                picture.write_bytes(made.read_bytes())
    for command, printed in zip(commands, outputs, strict=True):
        if not command.expected:
            continue
        shown = f"$ {command.script}\n" + "\n".join(command.expected)
        renewed = f"$ {command.script}\n" + "\n".join(renewed_lines(command.expected, printed))
        text = text.replace(shown, renewed)
    page.write_text(text)
    return text != before


def main(pages: Sequence[str]) -> None:
    """Renews pages, and names those that changed."""
    for page in pages or WITH_EXACT_NUMBERS:
        print(f"{page}: {'written anew' if rewrite(_ROOT / page) else 'as it was'}", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
