"""The options and the examples that every command has."""

from __future__ import annotations

import shlex

import pytest
from typer.main import get_command

from drivora_service.cli.command_examples import EXAMPLES
from drivora_service.cli.command_tree import commands_of, complete_commands
from drivora_service.cli.main import app

ROOT = get_command(app)
complete_commands(ROOT)
COMMANDS = dict(commands_of(ROOT))


def test_every_command_has_examples_and_every_example_a_command() -> None:
    assert EXAMPLES.keys() == COMMANDS.keys()
    assert all(examples for examples in EXAMPLES.values())


@pytest.mark.parametrize(
    ("words", "example"), [(words, one) for words, lines in EXAMPLES.items() for one in lines]
)
def test_an_example_is_understood_by_the_parser(words: str, example: str) -> None:
    program, *arguments = shlex.split(example)
    given = words.split()
    assert program == "drivora"
    assert arguments[: len(given)] == given
    # Raises what the command line would print: an option, an argument or a value is not known.
    context = COMMANDS[words].make_context(words, arguments[len(given) :])
    assert context.params
    # At 80 columns, with the indentation of the help, in one line.
    assert len(example) <= 76


def test_the_help_shows_the_examples_line_by_line() -> None:
    command = COMMANDS["campaign run"]
    shown = command.get_help(command.make_context("run", ["campaign.yaml"]))
    for example in EXAMPLES["campaign run"]:
        assert f"    {example}\n" in shown
    assert "-v, --verbose" in shown


def test_completing_twice_adds_nothing() -> None:
    before = len(COMMANDS["run"].params)
    complete_commands(ROOT)
    assert len(COMMANDS["run"].params) == before
