"""Names and texts that act on a terminal, a page, a report or a spreadsheet that shows them raw.

The tests of all writers use them: what one format takes as text, another executes.
"""

from __future__ import annotations

import re

ACTING = (
    "red \x1b[31mtext\x1b[0m",
    "title \x1b]0;owned\x07",
    "cleared \x1b[2J\x1b[H",
    "bell \x07",
    "over\rwritten",
    "two\nlines",
    "back\b\b\b\b",
    "control \x9b31m sequence",
    "next\x85line",
    "delete \x7f",
    "null \x00",
    "abc\u202egpj.exe",
    "isolated \u2066left\u2069",
    "mark \u200e\u200f\u061c",
    "line\u2028separator",
    "paragraph\u2029separator",
    "zero\u200bwidth",
    "\ufeffmarked",
    "soft\u00adhyphen",
    "tag \U000e0041\U000e007f",
)
"""Names that are refused where users give them; older data may have them."""

MARKUP = (
    "<script>alert(1)</script>",
    "<img src=x onerror=alert(1)>",
    '"><svg/onload=alert(1)>',
    "' onmouseover='alert(1)",
    "</style></title><script>alert(1)</script>",
    "]]><!ENTITY x SYSTEM 'file:///etc/passwd'>&x;",
    "&lt;script&gt;",
    "[link](javascript:alert(1))",
    "![](https://example.com/x.png)",
    "`code` and ``` fence",
    "| cell | cell |",
    "# heading",
    "- item",
    "> quote",
    "* star *",
    "{{ 7 * 7 }}{% raw %}",
    "$\\alpha_{1}$ and $x",
    "[bold]rich[/bold]",
    "%s %(name)s {0}",
    "ünïcödé 日本語 🚗",
)
"""Names that are allowed, whatever they mean to a format."""

FORMULAS = ("=1+1", "+1+1", "-1+1", "@SUM(A1)", "=cmd|' /C calc'!A0", "\uff1d1+1", "'=1")
"""Names that spreadsheets would calculate."""

NAMES = (*ACTING, *MARKUP, *FORMULAS)
"""All of them."""

_SGR = re.compile("\x1b\\[[0-9;]*m")
_ACTS = re.compile(
    "[\u0000-\u0008\u000b-\u001f\u007f-\u009f\u2028\u2029\u061c\u200e\u200f\u202a-\u202e"
    "\u2066-\u2069\u00ad\u200b\u2060-\u2064\u206a-\u206f\ufeff\ufff9-\ufffb"
    "\U000e0000-\U000e007f\ud800-\udfff]"
)


def acting_characters(text: str, *, has_colors: bool = False) -> list[str]:
    """Returns the characters of a text that act on what shows it; line feeds and tabs do not.

    Args:
        text: What a writer wrote.
        has_colors: Whether codes of colors and styles are allowed.
    """
    return _ACTS.findall(_SGR.sub("", text) if has_colors else text)
