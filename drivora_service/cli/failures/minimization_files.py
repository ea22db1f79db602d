"""The files of a minimisation: the smallest scenario, the report, both runs side by side."""

from __future__ import annotations

import json
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from drivora_service.cli.failures.minimization_output import title_of
from drivora_service.cli.terminal.out_option import convert_write_errors, write_result
from drivora_service.cli.terminal.output import note
from drivora_service.cli.terminal.private_files import give_to_user
from drivora_service.shapes import adapter

if TYPE_CHECKING:
    from drivora_service.api.schemas.minimizations import Minimization
    from drivora_service.client import Client

SCENARIO, REPORT, PICTURE = "minimal.json", "minimization.json", "side-by-side.svg"
"""Names of the files in a folder."""


def write_document(minimization: Minimization, path: Path) -> None:
    """Writes the smallest scenario.

    Raises:
        ConfigurationError: It cannot be written.
    """
    write_result(path, json.dumps(minimization.document, indent=2, ensure_ascii=False) + "\n")
    note(str(path))


def write_folder(
    client: Client, minimization: Minimization, folder: Path, *, data_dir: Path | None
) -> None:
    """Writes the smallest scenario, the report, and a picture of both runs if it has ended.

    Raises:
        ConfigurationError: A file cannot be written.
        ServiceError: The recordings cannot be fetched.
        TraceDamaged: One is not that of its run.
    """
    write_document(minimization, folder / SCENARIO)
    report = adapter(type(minimization)).dump_python(minimization, mode="json")
    write_result(folder / REPORT, json.dumps(report, indent=2, ensure_ascii=False) + "\n")
    note(str(folder / REPORT))
    if minimization.minimal_run_id:
        _draw(client, minimization, folder / PICTURE, data_dir=data_dir)
        note(str(folder / PICTURE))


def _draw(
    client: Client, minimization: Minimization, target: Path, *, data_dir: Path | None
) -> None:
    from drivora_service.cli.application.installation import network_catalogue, settings_for
    from drivora_service.observations.trace_files.checked_trace import read_checked_trace
    from drivora_service.observations.trace_files.stored_trace import StoredTrace
    from drivora_service.plotting.side_by_side import Side, draw_side_by_side

    sides = []
    sizes = (minimization.before, minimization.after)
    run_ids = (minimization.reproduction_run_id, minimization.minimal_run_id)
    with tempfile.TemporaryDirectory(prefix="drivora-") as scratch:
        for name, size, run_id in zip(("before", "after"), sizes, run_ids, strict=True):
            path = Path(scratch) / f"{name}.trace.parquet"
            client.save_run_observations(path, run_id)
            title = name if size is None else title_of(size, name)
            run = client.run(run_id)
            found = minimization.failure.find_in(run.verdicts)
            verdicts = () if found is None else (found,)
            stored = StoredTrace(run_id=run_id, path=path, sha256=run.trace_sha256)
            sides.append(Side(title=title, trace=read_checked_trace(stored), verdicts=verdicts))
    network = network_catalogue(settings_for(data_dir)).get(sides[0].trace.network)
    with convert_write_errors(target):
        draw_side_by_side(sides[0], sides[1], network, target)
        give_to_user(target)
