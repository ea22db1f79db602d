"""``drivora store``."""

from __future__ import annotations

import typer

app = typer.Typer(help="The database and the traces.", no_args_is_help=True)


@app.callback()
def store() -> None:
    """The database and the traces."""
