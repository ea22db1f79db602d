"""The runnable blocks of a page.

- `console` blocks hold commands behind ``$`` and what they print, in part: ``…`` stands for text
  that is left out.
- `bash` blocks are scripts.
- ``<!-- file: NAME -->`` before a block of any kind: it is the content of a file;
  ``<!-- append: NAME -->``: it is added to one.
- ``<!-- fails -->`` before a `console` block: its last command exits with an error.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

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
    """Gives the commands of a page in order, the writing of its files among them."""
    commands: list[Command] = []
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
    """Gives the lines of `sh` blocks: what is typed once, to install."""
    texts = [block["text"] for block in _BLOCK.finditer(page) if block["language"] == "sh"]
    return [line for text in texts for line in text.splitlines() if line]


def _console(text: str) -> list[Command]:
    commands: list[Command] = []
    for part in re.split(r"^\$ ", text, flags=re.MULTILINE)[1:]:
        lines = part.splitlines()
        length = 1 + next(i for i, line in enumerate(lines) if not line.endswith("\\"))
        commands.append(Command("\n".join(lines[:length]), tuple(lines[length:])))
    return commands


def missing_lines(expected: tuple[str, ...], printed: str) -> list[str]:
    """Gives the expected lines that were not printed, in order; numbers and ids may differ."""
    actual = iter([_loosely(line) for line in printed.splitlines()])
    missing = []
    for line in expected:
        wanted = _loosely(line)
        if wanted in ("", "…"):
            continue
        pattern = ".*".join(re.escape(part) for part in re.split(r" ?… ?", wanted))
        if not any(re.fullmatch(pattern, candidate) for candidate in actual):
            missing.append(line)
            actual = iter([_loosely(line) for line in printed.splitlines()])
    return missing


def _loosely(line: str) -> str:
    line = re.sub(r"\b(?:[0-9a-f]{64}|[0-9a-f]{24})\b", "ID", line.replace("─", ""))
    line = re.sub(r"\d+(?:\.\d+)?", "#", line)
    return " ".join(line.split())
