"""``drivora laws``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from drivora_service.cli.exit_codes import ExitCode
from drivora_service.cli.terminal.options import DataDirOption
from drivora_service.cli.terminal.output import JsonOption, fail, print_json, print_table, say
from drivora_service.cli.terminal.output_forms import TABLE, Form, with_forms

if TYPE_CHECKING:
    from drivora_service.oracles.laws.law import Law

app = typer.Typer(help="Traffic laws as formulas, by which runs are judged.", no_args_is_help=True)


@app.command("list")
@with_forms
def list_laws(data_dir: DataDirOption = None, form: Form = TABLE) -> None:
    """Lists the laws that judge runs here: shipped ones, and those of your files."""
    from drivora_service.cli.application.installation import oracle_catalogue, settings_for

    library = oracle_catalogue(settings_for(data_dir)).library
    laws = [library.law(name) for name in library.names()]
    if not form.is_table:
        told = [_plain(law) for law in laws]
        form.print_content(
            {
                "laws": told,
                "broken": [
                    {"file": one.file, "reason": one.reason} for one in library.broken.values()
                ],
            },
            told,
        )
        return
    print_table(
        "",
        ("name", "file", "severity", "description"),
        (
            (
                law.name,
                "shipped" if library.is_shipped(law.name) else law.file,
                str(law.severity),
                law.description,
            )
            for law in laws
        ),
        wrap=("description",),
    )
    for broken in library.broken.values():
        fail(f"{broken.file} cannot be used, and no run can be judged:\n{broken.reason}")


@app.command()
def check(
    files: Annotated[
        list[Path], typer.Argument(metavar="FILE…", help="Law files (YAML).", dir_okay=False)
    ],
    as_json: JsonOption = False,
) -> None:
    """Checks law files and shows in which ways each law can be violated.

    Exits with 1 if a file cannot be used; every mistake is named with its line and column.
    """
    from drivora_service.errors import InvalidDocument
    from drivora_service.oracles.laws.law_reading import read_laws
    from drivora_service.oracles.laws.sources import read_law_source

    checked: list[dict[str, Any]] = []
    wrong = False
    for path in files:
        try:
            laws = read_laws(read_law_source(path))
        except InvalidDocument as error:
            wrong = True
            problems = [
                {"pointer": one.pointer, "code": one.code, "message": one.message}
                for one in error.problems
            ]
            checked.append({"file": str(path), "laws": [], "problems": problems})
            if not as_json:
                for one in error.problems:
                    fail(one.message)
            continue
        checked.append({"file": str(path), "laws": [_plain(law) for law in laws], "problems": []})
        if not as_json:
            for law in laws:
                _print_law(law)
    if as_json:
        print_json({"files": checked})
    if wrong:
        raise typer.Exit(ExitCode.GATE_FAILED)


def _print_law(law: Law) -> None:
    say(f"{law.name}: {law.title}")
    say(f"  {law.text}")
    ways = len(law.sub_violations)
    say(f"  violated in {ways} {'way' if ways == 1 else 'ways'}:")
    for number, case in enumerate(law.sub_violations, start=1):
        say(f"  {number}. {case}")


def _plain(law: Law) -> dict[str, Any]:
    return {
        "name": law.name,
        "title": law.title,
        "source": law.source,
        "description": law.description,
        "left_out": law.left_out,
        "severity": str(law.severity),
        "file": law.file,
        "sha256": law.sha256,
        "parameters": [
            {"name": one.name, "value": one.value, "unit": one.unit, "meaning": one.meaning}
            for one in law.parameters
        ],
        "formula": law.text,
        "sub_violations": [str(case) for case in law.sub_violations],
    }
