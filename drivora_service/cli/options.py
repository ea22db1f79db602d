"""Options that several commands share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

ServerOption = Annotated[
    str,
    typer.Option(
        "--server",
        metavar="URL",
        envvar="DRIVORA_SERVER",
        help="Ask the service at URL (token: DRIVORA_TOKEN) rather than work here.",
    ),
]
DataDirOption = Annotated[
    Path | None,
    typer.Option(
        "--data-dir",
        metavar="DIR",
        help="Folder of the database, traces and imported networks [default: drivora-data].",
    ),
]
