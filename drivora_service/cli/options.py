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
GateRuleOption = Annotated[
    list[str] | None,
    typer.Option(
        "--gate-rule",
        metavar="RULE[=RUNS]",
        help="Exit with 1 if RULE was broken in more than RUNS runs [default: 0]; may be repeated; "
        "rules that are not named do not count then.",
    ),
]
