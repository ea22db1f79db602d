"""``drivora rejudge``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from drivora_service.cli.exit_codes import ExitCode
from drivora_service.cli.terminal.options import DataDirOption
from drivora_service.cli.terminal.output import JsonOption, print_json, print_table


def rejudge(
    traces: Annotated[
        list[Path],
        typer.Argument(metavar="TRACE…|FOLDER", help="Trace files (.parquet), or folders of them."),
    ],
    data_dir: DataDirOption = None,
    as_json: JsonOption = False,
) -> None:
    """Judges stored traces by the current oracles and prints the changes.

    Earlier verdicts are read from the report beside a trace (NAME.report.json). Exits with 1 if
    a verdict changed, and with 3 if a trace could not be judged.
    """
    from drivora_service.cli.application.installation import (
        network_catalogue,
        oracle_catalogue,
        settings_for,
    )
    from drivora_service.cli.runs.rejudging import find_traces, rejudge
    from drivora_service.oracles.verdicts.verdict_json import verdict_content

    settings = settings_for(data_dir)
    networks, oracles = network_catalogue(settings), oracle_catalogue(settings)
    done = [rejudge(path, networks, oracles) for path in find_traces(traces)]
    changes = [(one.trace, change) for one in done for change in one.changes]
    if as_json:
        runs = [
            {
                "trace": str(one.trace),
                "error": one.error,
                "compared": one.compared,
                "changes": [
                    {"oracle": c.oracle, "ego": c.ego, "before": c.before, "after": c.after}
                    for c in one.changes
                ],
                "verdicts": [verdict_content(verdict) for verdict in one.verdicts],
            }
            for one in done
        ]
        print_json({"runs": runs})
    else:
        if changes:
            rows = [
                (path.name.partition(".")[0], c.oracle, c.ego, c.before, c.after)
                for path, c in changes
            ]
            columns = ("run", "oracle", "ego", "before", "after")
            print_table("", columns, rows, wrap=("before", "after"))
        for one in done:
            if one.error:
                print(f"{one.trace}: {one.error}")
            elif not one.compared:
                print(f"{one.trace}: judged; there is no report beside it to compare with")
        changed = sum(1 for one in done if one.changes)
        compared = sum(1 for one in done if one.compared)
        print(f"Traces: {len(done)}; compared: {compared}; changed: {changed}")
    if any(one.error for one in done):
        raise typer.Exit(ExitCode.NOT_DONE)
    if changes:
        raise typer.Exit(ExitCode.GATE_FAILED)
