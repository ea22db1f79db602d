"""Text of users in Markdown."""

from __future__ import annotations

_MARKUP = "\\`*_[]<>|#"


def escaped(text: str) -> str:
    """Returns a text on one line, without what Markdown would read as markup or HTML."""
    for character in _MARKUP:
        text = text.replace(character, f"\\{character}")
    return text.replace("\n", " ")
