"""Characters that act on what shows a text, instead of being seen in it; how writers show them.

Such characters are refused in names that users give (``given_names``). Names of older data, and
texts of agents and plug-ins, may have them all the same: every writer passes what it did not write
itself through :func:`visible_text`, and then through what its own format needs.
"""

from __future__ import annotations

import json
import re
import unicodedata

_OTHERS = (
    "\u007f-\u009f"  # DEL and C1: begin escape sequences as well.
    "\u2028\u2029"  # Line and paragraph separator.
    "\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069"  # Directions: text is read in another order.
    # Without any width, so that different names look equal. The joiners U+200C and U+200D are
    # allowed: words in Persian and Hindi, and many emoji, are spelled with them.
    "\u00ad\u200b\u2060-\u2064\u206a-\u206f\ufeff\ufff9-\ufffb\U000e0000-\U000e007f"
    "\ud800-\udfff"  # Halves of characters, which no encoding can write.
)
# C0 moves cursors, rings, begins escape sequences; line feeds and tabs are wanted in some texts.
_ACTING = re.compile(f"[\u0000-\u001f{_OTHERS}]")
_ACTING_BESIDE_LINES = re.compile(f"[\u0000-\u0008\u000b-\u001f{_OTHERS}]")
_CONTROL_NAMES = {
    "\a": "bell",
    "\b": "backspace",
    "\t": "tab",
    "\n": "line feed",
    "\r": "carriage return",
    "\x1b": "escape",
    "\x7f": "delete",
    "\x85": "next line",
    "\x9b": "control sequence",
}


def visible_text(text: str, *, has_lines: bool = False) -> str:
    r"""Returns a text with each acting character as JSON writes it, such as ``\u001b``.

    So a document of JSON stays what it is.

    Args:
        text: Any text.
        has_lines: Whether it may have several lines: line feeds and tabs then stay.
    """
    if text.isprintable():
        # Nothing that acts is; most texts of large tables are returned here.
        return text
    acting = _ACTING_BESIDE_LINES if has_lines else _ACTING
    if has_lines:
        # Lines of other systems, which would otherwise end with a visible carriage return.
        text = text.replace("\r\n", "\n")
    return acting.sub(lambda found: _written(found[0]), text)


def describe_acting_character(text: str, *, has_lines: bool = False) -> str:
    """Returns what the first acting character of a text is, and where; "" if it has none.

    Args:
        text: Any text.
        has_lines: Whether line feeds and tabs are allowed.
    """
    found = (_ACTING_BESIDE_LINES if has_lines else _ACTING).search(text)
    if found is None:
        return ""
    name = _CONTROL_NAMES.get(found[0]) or unicodedata.name(found[0], "control character").lower()
    code = f"U+{ord(found[0]):04X}"
    return f"{code} ({name}) as character {found.start() + 1} of {len(text)}"


def _written(character: str) -> str:
    # As JSON: two halves for a character beyond U+FFFF.
    return json.dumps(character)[1:-1] if character != "\x7f" else "\\u007f"
