"""The forms in which commands print results for programs."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Mapping
from typing import Any

import pytest
import typer
from typer.core import TyperGroup

from drivora_service.cli.terminal.output_forms import Form, FormKind, read_form, with_forms
from drivora_service.errors import ConfigurationError
from tests.built_commands import COMMANDS

ITEMS: list[Mapping[str, Any]] = [
    {
        "id": "01a2",
        "name": "acme, first",
        "counts": {"failing": 2},
        "kinds": [{"kind": "collision"}, {"kind": "red_light"}],
        "rate": 1.5,
        "message": None,
    },
    {"id": "01a3", "name": 'says "no"\nand more', "rate": float("nan"), "best": True},
]


def printed(
    capsys: pytest.CaptureFixture[str], form: Form, content: Any = ITEMS, **others: Any
) -> str:
    form.print_content(content, **others)
    return capsys.readouterr().out


def read(text: str = "", *, as_json: bool = False, id_only: bool = False) -> Form:
    return read_form(as_json=as_json, text=text, id_only=id_only)


@pytest.mark.parametrize("form", [read("json"), read(as_json=True)])
def test_json_is_the_content(capsys: pytest.CaptureFixture[str], form: Form) -> None:
    found = json.loads(printed(capsys, form))
    assert found[0] == ITEMS[0]
    assert found[1]["rate"] is None


def test_json_lines_are_the_items(capsys: pytest.CaptureFixture[str]) -> None:
    lines = printed(capsys, read("jsonl")).splitlines()
    assert [json.loads(line)["id"] for line in lines] == ["01a2", "01a3"]
    inner = printed(capsys, read("jsonl"), {"batch_id": "b", "runs": ITEMS}, items=ITEMS)
    assert inner.splitlines() == lines


def test_csv_has_the_keys_of_all_items_and_can_be_read_again(
    capsys: pytest.CaptureFixture[str],
) -> None:
    first, second = csv.DictReader(io.StringIO(printed(capsys, read("csv"))))
    assert list(first) == ["id", "name", "counts", "kinds", "rate", "message", "best"]
    assert json.loads(first["kinds"]) == ITEMS[0]["kinds"]
    assert (first["message"], first["best"]) == ("", "")
    assert (second["name"], second["rate"], second["best"]) == ('says "no"\nand more', "", "true")


def test_csv_of_nothing_is_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    assert printed(capsys, read("csv"), []) == ""


@pytest.mark.parametrize(
    ("template", "lines"),
    [
        ("{id}", ["01a2", "01a3"]),
        ("{ id }", ["01a2", "01a3"]),
        (r"{id}\t{rate}", ["01a2\t1.5", "01a3\t"]),
        ("run {id}!", ["run 01a2!", "run 01a3!"]),
    ],
)
def test_a_line_of_fields(
    capsys: pytest.CaptureFixture[str], template: str, lines: list[str]
) -> None:
    assert printed(capsys, read(template)).splitlines() == lines


def test_fields_reach_into_objects_and_lists(capsys: pytest.CaptureFixture[str]) -> None:
    form = read("{counts.failing} {kinds.1.kind} {message.text}")
    assert printed(capsys, form, ITEMS[0]) == "2 red_light \n"
    assert json.loads(printed(capsys, read("{kinds}"), ITEMS[0])) == ITEMS[0]["kinds"]


@pytest.mark.parametrize(
    ("template", "message"),
    [
        ("{idd}", "no field 'idd' here; there are: id, name, counts, kinds, rate, message"),
        ("{counts.x}", "no field 'counts.x' here; there are: failing"),
        ("{kinds.2}", "no field 'kinds.2' here; the list has 2 elements, numbered from 0"),
        ("{rate.x}", "no field 'rate.x' here; 1.5 has no fields"),
    ],
)
def test_an_unknown_field_is_named_with_those_that_there_are(template: str, message: str) -> None:
    with pytest.raises(ConfigurationError) as raised:
        read(template).print_content(ITEMS[0])
    assert message in str(raised.value)


def test_ids_alone(capsys: pytest.CaptureFixture[str]) -> None:
    form = read(id_only=True)
    assert printed(capsys, form) == "01a2\n01a3\n"
    assert printed(capsys, form, [{"name": "idm"}]) == "idm\n"
    assert (
        printed(capsys, form, [{"replay": {"id": "x"}}, {"replay": None}], id_field="replay.id")
        == "x\n"
    )
    # Of a scenario that cannot be run.
    assert printed(capsys, form, [{"id": ""}]) == ""


@pytest.mark.parametrize("text", ["xml", "id", "{}", "{id} { }", "tables"])
def test_what_is_no_form_is_refused(text: str) -> None:
    with pytest.raises(typer.BadParameter):
        read(text)


def test_forms_exclude_one_another() -> None:
    for options in ({"as_json": True}, {"id_only": True}):
        with pytest.raises(typer.BadParameter, match="exclude one another"):
            read("csv", **options)
    with pytest.raises(typer.BadParameter):
        read(as_json=True, id_only=True)


def test_without_options_it_is_a_table() -> None:
    assert read().is_table
    assert read("table") == Form(FormKind.TABLE)


def test_a_command_gets_the_form_in_place_of_the_options() -> None:
    asked: list[tuple[str, Form]] = []

    @with_forms
    def command(name: str, form: Form = read()) -> None:  # noqa: B008 # frozen
        asked.append((name, form))

    app = typer.Typer()
    app.command()(command)
    from typer.testing import CliRunner

    run = CliRunner().invoke
    assert run(app, ["x", "--id-only"]).exit_code == 0
    assert run(app, ["y", "--format", "{id}"]).exit_code == 0
    assert run(app, ["z", "--json", "--id-only"]).exit_code == 2
    assert asked == [("x", Form(FormKind.IDS)), ("y", Form(FormKind.TEMPLATE, "{id}"))]


def test_every_list_and_show_prints_ids_and_fields() -> None:
    assert isinstance(COMMANDS, TyperGroup)
    lacking = []
    for name, group in COMMANDS.commands.items():
        for verb, command in getattr(group, "commands", {}).items():
            options = {option for parameter in command.params for option in parameter.opts}
            is_meant = verb in ("list", "show", "run", "resume")
            if is_meant and not {"--json", "--format", "--id-only"} <= options:
                lacking.append(f"{name} {verb}")
    assert lacking == []
