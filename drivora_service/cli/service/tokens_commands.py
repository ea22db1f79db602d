"""``drivora tokens``."""

from __future__ import annotations

import sys
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from drivora_service.cli.terminal.options import DataDirOption
from drivora_service.cli.terminal.output import JsonOption, note, print_json, print_table, say
from drivora_service.cli.terminal.output_forms import TABLE, Form, with_forms
from drivora_service.errors import StoreError

if TYPE_CHECKING:
    from drivora_service.api.guards.api_tokens import TokenFile

app = typer.Typer(
    help="API tokens; once one was made, every request to the service needs one.",
    no_args_is_help=True,
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
    tokens = _tokens(data_dir)
    was_needed = tokens.are_needed
    secret = tokens.create(name, Scope[scope.name])
    try:
        if as_json:
            print_json({"name": name, "scope": scope.value, "token": secret})
        else:
            say(secret)
        sys.stdout.flush()
    except OSError as error:
        # A token that no one has seen is of no use, and would only take its name.
        tokens.revoke(name)
        raise StoreError(
            f"the token could not be printed ({error.strerror or error}) and was revoked; "
            "try again where the output can be written"
        ) from error
    if not was_needed:
        note(
            "This is the first token. A service with this data folder needs a token for every "
            "request from now on, also on loopback; commands with --server send that in "
            "DRIVORA_TOKEN."
        )


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
    tokens = _tokens(data_dir)
    tokens.revoke(name)
    say(f"revoked {name}")
    if not tokens.all():
        note(
            "No token is left: a service with this data folder refuses every request until "
            "`drivora tokens create` makes one, and does not start without one."
        )


def _tokens(data_dir: Path | None) -> TokenFile:
    from drivora_service.api.guards.api_tokens import TokenFile
    from drivora_service.cli.application.installation import settings_for

    return TokenFile(settings_for(data_dir).tokens_path, always_needed=False)
