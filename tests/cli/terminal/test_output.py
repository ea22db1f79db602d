"""What commands print, with hostile names: nothing reaches a terminal that acts on it."""

from __future__ import annotations

import ast
import json
from pathlib import Path

import pytest

from drivora_service.cli.terminal.output import (
    fail,
    note,
    print_json,
    print_prose,
    print_table,
    say,
    write_text,
)
from drivora_service.cli.terminal.output_forms import Form, FormKind
from drivora_service.cli.terminal.run_progress import run_progress
from tests.hostile_names import NAMES, acting_characters

_CLI = Path(__file__).resolve().parents[3] / "drivora_service" / "cli"
_MAY_PRINT = {"output.py", "plugin_probe.py", "speed_probe.py"}
"""The functions by which all others print, and processes whose output is read by a command."""


@pytest.fixture(params=[True, False], ids=["terminal", "pipe"])
def is_terminal(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> bool:
    if request.param:
        monkeypatch.setenv("FORCE_COLOR", "1")
        monkeypatch.setenv("TERM", "xterm-256color")
    return bool(request.param)


@pytest.mark.parametrize("name", NAMES, ids=ascii)
def test_nothing_that_is_printed_acts(
    name: str, is_terminal: bool, capsys: pytest.CaptureFixture[str]
) -> None:
    say(f"Campaign ({name}) is queued")
    say(name, is_error=True)
    note(f"interrupted: {name}")
    fail(f"unknown campaign {name}")
    write_text(f"# {name}\n", None)
    print_prose(f"a sentence about {name}")
    print_table(name, (f"a{name}", "b"), [(name, name), ("x", name)], headings=(name, name))
    for kind in FormKind:
        template = "{id}\t{name}" if kind is FormKind.TEMPLATE else ""
        Form(kind, template).print_content([{"id": name, "name": name, "seeds": [name]}])
    with run_progress([name], total=1) as count:
        count(name)
    written = capsys.readouterr()
    assert acting_characters(written.out, has_colors=is_terminal) == []
    # The bar of rich also moves the cursor, on a terminal.
    assert is_terminal or acting_characters(written.err) == []
    assert not set(written.err) & set(name) & {"\x07", "\u202e", "\x9b", "\u2028", "\x00"}


@pytest.mark.parametrize("name", NAMES, ids=ascii)
def test_json_has_the_name_itself(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    print_json({"name": name})
    Form(FormKind.JSONL).print_content([{"name": name}])
    whole, _, line = capsys.readouterr().out.partition("\n}\n")
    assert json.loads(f"{whole}}}") == json.loads(line) == {"name": name}


def test_numbers_of_csv_are_no_formulas(capsys: pytest.CaptureFixture[str]) -> None:
    Form(FormKind.CSV).print_content([{"name": "-1", "value": -1.5, "is": True, "none": None}])
    assert capsys.readouterr().out == "name,value,is,none\n'-1,-1.5,true,\n"


def test_all_commands_print_by_these_functions() -> None:
    found = []
    for path in sorted(_CLI.rglob("*.py")):
        if path.name in _MAY_PRINT:
            continue
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call):
                called = ast.unparse(node.func)
                if called in {"print", "typer.echo", "typer.secho", "click.echo"}:
                    found.append(f"{path.relative_to(_CLI)}:{node.lineno}: {called}")
                if called.endswith((".stdout.write", ".stderr.write")):
                    found.append(f"{path.relative_to(_CLI)}:{node.lineno}: {called}")
    assert found == []
