"""Changes texts token by token, so that most of what comes out is still nearly a document."""

from __future__ import annotations

import random
import re
from collections.abc import Iterable

_TOKEN = re.compile(
    r'"(?:[^"\\\n]|\\.)*"|\'[^\'\n]*\'|[-+]?[0-9][0-9.eE+-]*|[A-Za-z_][\w.:-]*|\s+|.', re.DOTALL
)
_NUMBER = re.compile(r"[-+]?[0-9][0-9.eE+-]*")
_PIECE = re.compile(r"<[^<>]*>|\{[^{}]*\}|\[[^\[\]]*\]|^.*\n", re.MULTILINE)
_NUMBERS = (
    *("0", "-0", "1", "-1", "2", "0.5", "1e-9", "1e9", "1e300", "-1e300", "1e400", "NaN", "nan"),
    *(
        "Infinity",
        "-inf",
        "4294967296",
        "9223372036854775808",
        "1_0",
        "0x10",
        "007",
        "1e",
        "\u0661",
    ),
    "9" * 5000,
)
_TEXTS = (
    *('""', '"\\u0000"', '"\\ud800"', '"a/b~c"', '"../x"', '"\u00e4\U0001f697"', '" "', '"-1"'),
    *("null", "true", "[]", "{}", "[[]]", '{"":0}', "&amp;", "&#0;", "&x;", "<!--", "<![CDATA["),
    *("<!DOCTYPE x>", "&a", "*a", "!!python/name:os.system", "? ", "- ", "|", "2001-02-30", "~"),
    *("\ufeff", "\x00", "\x85", "\u2028", '"' + "x" * 70 + '"', "[" * 40, "{'a':" * 40, "<a>" * 40),
)
_ODD = (*_TEXTS, *_NUMBERS)


class Mutator:
    """Makes a new text of one or two others."""

    def __init__(self, seeds: Iterable[bytes], words: Iterable[str]) -> None:
        self._seeds = tuple(seeds)
        texts = [seed.decode("utf-8", "replace") for seed in self._seeds]
        found = {token for text in texts for token in _TOKEN.findall(text) if not token.isspace()}
        self._known: list[str] = sorted(found | set(words))
        self._quoted = [word for word in self._known if len(word) > 1 and word[0] in "\"'"]
        self._pieces: list[str] = sorted(
            {piece for text in texts for piece in _PIECE.findall(text)}
        )

    def mutate(self, data: bytes, max_length: int, seed: int) -> bytes:
        """Returns a changed copy of it, or of a seed, of at most ``max_length`` bytes."""
        draw = random.Random(seed)
        # What covers most that is new is mostly broken early; from seeds, more is read.
        if draw.random() < 0.3:
            data = draw.choice(self._seeds)
        text = data.decode("utf-8", "surrogateescape")
        for _ in range(draw.choice((1, 1, 1, 2, 3, 5))):
            text = self._changed(text, draw)
        return text.encode("utf-8", "surrogateescape")[:max_length]

    def _changed(self, text: str, draw: random.Random) -> str:
        if draw.random() < 0.2:
            return self._with_piece(text, draw)
        tokens: list[str] = _TOKEN.findall(text)
        if not tokens:
            return draw.choice(self._pieces or self._known or [" "])
        place = draw.randrange(len(tokens))
        match draw.randrange(20):
            case 0:
                del tokens[place : place + draw.choice((1, 1, 2, 5, 20))]
            case 1:
                other = draw.randrange(len(tokens))
                tokens[place], tokens[other] = tokens[other], tokens[place]
            case 2:
                tokens.insert(place, self._word(draw))
            case 3:
                end = place + draw.choice((1, 2, 5, 20))
                tokens[place:place] = tokens[place:end] * draw.choice((1, 1, 2, 30))
            case _:
                # Blanks are half of the tokens, and the least interesting to replace.
                while tokens[place].isspace() and place + 1 < len(tokens):
                    place += 1
                tokens[place] = self._like(tokens[place], draw)
        return "".join(tokens)

    def _with_piece(self, text: str, draw: random.Random) -> str:
        """Removes, repeats, replaces or inserts an element, an innermost object or a line."""
        spans = [match.span() for match in _PIECE.finditer(text)]
        if not spans:
            return text + draw.choice(self._pieces or [""])
        start, end = draw.choice(spans)
        here = text[start:end]
        new = draw.choice(("", here * 2, draw.choice(self._pieces or [""]), here))
        if new == here:
            place, _ = draw.choice(spans)
            return text[:place] + new + text[place:]
        return text[:start] + new + text[end:]

    def _like(self, token: str, draw: random.Random) -> str:
        quote = token[0] if len(token) > 1 and token[0] in "\"'" else ""
        inner = token[1:-1] if quote else token
        if _NUMBER.fullmatch(inner) and draw.random() < 0.9:
            return quote + self._number(inner, draw) + quote
        if quote and draw.random() < 0.5:
            numbers = inner.split(" ")
            place = draw.randrange(len(numbers))
            numbers[place] = draw.choice((*_NUMBERS, "", inner, self._word(draw).strip("\"'")))
            return quote + " ".join(numbers) + quote
        if quote and draw.random() < 0.8:
            return draw.choice(self._quoted or [token])
        return self._word(draw)

    def _number(self, text: str, draw: random.Random) -> str:
        if draw.random() < 0.3:
            return draw.choice(_NUMBERS)
        try:
            value = float(text)
        except ValueError:
            return "0"
        changed = draw.choice((value + 1, value - 1, -value, 10 * value, 0.1 * value, value + 1e-3))
        return f"{changed:g}"

    def _word(self, draw: random.Random) -> str:
        known = self._known and draw.random() < 0.7
        return draw.choice(self._known if known else _ODD)
