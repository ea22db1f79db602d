"""``drivora examples``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from drivora_service.cli.terminal.out_option import check_folder, convert_write_errors
from drivora_service.cli.terminal.output import say
from drivora_service.errors import ConfigurationError


def examples(
    out: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Copy them there; existing files are not replaced."),
    ] = None,
) -> None:
    """Lists the files that come with Drivora, or copies them: scenarios, campaigns, suites.

    With --out, the paths of the copies are printed.
    """
    from drivora_service.cli.suites.suite_files import shipped_suites
    from drivora_service.scenario.scenario_schema import schema_directory

    folders = (schema_directory() / "examples", shipped_suites())
    files = {
        path.relative_to(folder if folder.name == "examples" else folder.parent): path
        for folder in folders
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }
    if out is None:
        say("\n".join(map(str, files)))
        return
    check_folder(out)
    taken = next((out / name for name in files if (out / name).exists()), None)
    if taken is not None:
        raise ConfigurationError(f"--out {out}: {taken} exists already; name another folder")
    with convert_write_errors(out):
        for name, path in files.items():
            copy = out / name
            copy.parent.mkdir(parents=True, exist_ok=True)
            copy.write_bytes(path.read_bytes())
    say("\n".join(str(out / name) for name in files))
