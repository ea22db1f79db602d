"""``drivora tokens``."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from drivora_service.cli.terminal.options import DataDirOption
from drivora_service.cli.terminal.output import JsonOption, print_json, print_table, say
from drivora_service.cli.terminal.output_forms import TABLE, Form, with_forms

if TYPE_CHECKING:
    from drivora_service.api.guards.api_tokens import TokenFile

app = typer.Typer(
    help="API tokens, needed when the service listens beyond loopback.", no_args_is_help=True
)


class ScopeName(StrEnum):
    """The scope of a token; each includes those before it."""

    READ = "read"
    SUBMIT = "submit"
    ADMIN = "admin"


@app.command()
def create(
    name: Annotated[str, typer.Argument(help="Name of the token, such as its user's.")],
    scope: Annotated[ScopeName, typer.Option(help="Scope of the token.")] = ScopeName.SUBMIT,
    data_dir: DataDirOption = None,
    as_json: JsonOption = False,
) -> None:
    """Makes a token and shows it once; only its hash is kept."""
    from drivora_service.api.guards.api_tokens import Scope
    from drivora_service.cli.terminal.private_files import keep_files_private

    keep_files_private()
    secret = _tokens(data_dir).create(name, Scope[scope.name])
    if as_json:
        print_json({"name": name, "scope": scope.value, "token": secret})
    else:
        say(secret)


@app.command("list")
@with_forms
def list_tokens(data_dir: DataDirOption = None, form: Form = TABLE) -> None:
    """Lists the tokens, without their secrets."""
    rows = [
        {
            "name": token.name,
            "scope": token.scope.name.lower(),
            "created": token.created.isoformat(timespec="seconds"),
        }
        for token in _tokens(data_dir).all()
    ]
    if not form.is_table:
        form.print_content(rows)
    else:
        print_table("", ("name", "scope", "created"), (tuple(row.values()) for row in rows))


@app.command()
def revoke(
    name: Annotated[str, typer.Argument(help="A token of `drivora tokens list`.")],
    data_dir: DataDirOption = None,
) -> None:
    """Makes a token worthless at once, also for a service that runs."""
    _tokens(data_dir).revoke(name)
    say(f"revoked {name}")


def _tokens(data_dir: Path | None) -> TokenFile:
    from drivora_service.api.guards.api_tokens import TokenFile
    from drivora_service.cli.application.installation import settings_for

    return TokenFile(settings_for(data_dir).tokens_path)
