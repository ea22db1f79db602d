"""Texts in pictures: names are drawn as they are written, whatever they contain."""

from __future__ import annotations

from matplotlib.figure import Figure
from matplotlib.text import Text

from drivora_service.visible_text import visible_text


def make_texts_plain(figure: Figure) -> None:
    """Makes every text of a figure plain, right before it is written.

    Matplotlib reads what is between two dollar signs as a formula, and fails where it is none; and
    an SVG with a control character is no XML.
    """
    for text in figure.findobj(Text):
        assert isinstance(text, Text)
        content = text.get_text()
        if "$" in content:
            text.set_parse_math(False)
        shown = visible_text(content, has_lines=True)
        if shown != content:
            text.set_text(shown)
