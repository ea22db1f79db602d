"""The runnable blocks of a page.

- `console` blocks hold commands behind ``$`` and what they print, in part: ``…`` stands for text
  that is left out.
- `bash` blocks are scripts.
- ``<!-- file: NAME -->`` before a block of any kind: it is the content of a file;
  ``<!-- append: NAME -->``: it is added to one.
- ``<!-- fails -->`` before a `console` block: its last command exits with an error.
- ``<!-- files of: PAGE -->``: the files of another page, which the reader has written before.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

_ROOT = Path(__file__).resolve().parents[2]
_FILES_OF = re.compile(r"^<!-- files of: (\S+) -->$", re.MULTILINE)
_BLOCK = re.compile(
    r"(?:<!-- (?P<directive>[a-z]+)(?:: (?P<name>\S+))? -->\n)?"
    r"^```(?P<language>[a-z]+)\n(?P<text>.*?)^```$",
    re.DOTALL | re.MULTILINE,
)


@dataclass(frozen=True, slots=True)
class Command:
    """Something to run, what it must print in part, and whether it must fail."""

    script: str
    expected: tuple[str, ...] = ()
    fails: bool = False


def commands_of(page: str) -> list[Command]:
    """Returns the commands of a page in order, the writing of its files among them."""
    commands = [
        command
        for other in _FILES_OF.findall(page)
        for command in commands_of((_ROOT / other).read_text())
        if command.script.startswith("mkdir -p ")
    ]
    for block in _BLOCK.finditer(page):
        directive, name, text = block["directive"], block["name"], block["text"]
        if directive in ("file", "append"):
            redirect = ">" if directive == "file" else ">>"
            script = f"mkdir -p \"$(dirname {name})\"\ncat {redirect} {name} <<'END'\n{text}END"
            commands.append(Command(script))
        elif block["language"] == "bash":
            commands.append(Command(text))
        elif block["language"] == "console":
            found = _console(text)
            if directive == "fails":
                found[-1] = Command(found[-1].script, found[-1].expected, fails=True)
            commands += found
    return commands


def installation_lines(page: str) -> list[str]:
    """Returns the lines of `sh` blocks: what is typed once, to install."""
    texts = [block["text"] for block in _BLOCK.finditer(page) if block["language"] == "sh"]
    return [line for text in texts for line in text.splitlines() if line]


def _console(text: str) -> list[Command]:
    commands: list[Command] = []
    for part in re.split(r"^\$ ", text, flags=re.MULTILINE)[1:]:
        lines = part.splitlines()
        length = 1 + next(i for i, line in enumerate(lines) if not line.endswith("\\"))
        commands.append(Command("\n".join(lines[:length]), tuple(lines[length:])))
    return commands


def missing_lines(expected: tuple[str, ...], printed: str, *, exact: bool = False) -> list[str]:
    """Returns the expected lines that were not printed, in order; ids may differ.

    Args:
        expected: What the page shows.
        printed: What was printed.
        exact: Whether numbers must be those that were printed, but for wall time and rates.
    """
    read = _exactly if exact else _loosely
    actual = iter([read(line) for line in printed.splitlines()])
    missing = []
    for line in expected:
        wanted = read(line)
        if wanted in ("", "…"):
            continue
        if not any(re.fullmatch(_pattern(wanted), candidate) for candidate in actual):
            missing.append(line)
            actual = iter([read(line) for line in printed.splitlines()])
    return missing


def renewed_lines(expected: tuple[str, ...], printed: str) -> tuple[str, ...]:
    """Returns the lines of a page as they are printed now; ``…`` stays where it stands.

    A line that is not printed any more, whatever its numbers, is left as it is.
    """
    left = printed.splitlines()
    renewed = []
    for line in expected:
        wanted = _loosely(line)
        matching = [
            n for n, text in enumerate(left) if re.fullmatch(_pattern(wanted), _loosely(text))
        ]
        if wanted in ("", "…") or not matching:
            renewed.append(line)
            continue
        exact = _pattern(_exactly(line))
        same = [n for n in matching if re.fullmatch(exact, _exactly(left[n]))]
        found = (same or matching)[0]
        renewed.append(line if same else _with_numbers_of(line, left[found]))
        left = left[found + 1 :]
    return tuple(renewed)


def _with_numbers_of(line: str, printed: str) -> str:
    """Puts the numbers that were printed into a line that has the same words."""
    if "…" not in line:
        return printed.rstrip()
    numbers = iter(_NUMBER.findall(_without_ids(printed)))
    head, _, rest = line.partition("…")
    head = _NUMBER.sub(lambda match: next(numbers, match[0]), head)
    return f"{head}…{rest}"


_NUMBER = re.compile(r"\d+(?:\.\d+)?")
_VOLATILE = re.compile(
    r"\d+(?:\.\d+)?(?=(?: s\b \(| µs| a second|/s))|(?<=\()\d+(?:\.\d+)?(?= a second)"
)
"""Numbers of wall time: ``in 6 s (15.70 a second)``, ``79 µs``, ``26.0/s``."""


def _pattern(wanted: str) -> str:
    return ".*".join(re.escape(part) for part in re.split(r" ?… ?", wanted))


def _without_ids(line: str) -> str:
    return re.sub(r"\b(?:[0-9a-f]{64}|[0-9a-f]{24})\b", "ID", line.replace("─", ""))


def _exactly(line: str) -> str:
    return " ".join(_VOLATILE.sub("#", _without_ids(line)).split())


def _loosely(line: str) -> str:
    return " ".join(_NUMBER.sub("#", _without_ids(line)).split())
