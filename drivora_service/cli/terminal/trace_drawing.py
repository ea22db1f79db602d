"""A picture of a run from its trace file."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path
from typing import Literal

from drivora_service.cli.application.installation import network_catalogue, oracle_catalogue
from drivora_service.cli.terminal.out_option import convert_write_errors
from drivora_service.cli.terminal.output import note
from drivora_service.cli.terminal.private_files import give_to_user
from drivora_service.errors import UnknownName
from drivora_service.observations.trace_files.trace_file import read_trace
from drivora_service.oracles.built_in import judge_all
from drivora_service.plotting.run_picture import draw_run
from drivora_service.plotting.strip import draw_strip
from drivora_service.settings import Settings


def draw_trace(
    path: Path,
    settings: Settings,
    target: Path,
    *,
    color_by: Literal["actor", "time"] = "actor",
    oracles: Collection[str] = (),
    moments: int | None = None,
) -> None:
    """Judges a trace and draws it.

    Args:
        path: Path of the trace.
        settings: Settings with the folder of imported networks.
        target: File to write; ends in ``.svg`` or ``.png``.
        color_by: Meaning of the colours of the egos' trails.
        oracles: Names of the oracles whose violations are marked; none: of all.
        moments: Draws a strip of so many moments rather than the whole run.

    Raises:
        StoreError: The file is no trace.
        UnknownName: Its network is not in the catalogue, or there is no such oracle.
        ConfigurationError: The picture cannot be written.
        OracleError: An oracle of a package cannot judge.
    """
    catalogue = oracle_catalogue(settings)
    known = catalogue.names()
    for name in oracles:
        if name not in known:
            raise UnknownName("oracle", name, known)
    # An oracle that cannot judge does not prevent a picture that marks other oracles only.
    chosen = [catalogue.oracle(name) for name in known if not oracles or name in oracles]
    trace = read_trace(path)
    network = network_catalogue(settings).get(trace.network)
    if network.sha256 != trace.network_sha256:
        note(f"network {network.name} has changed since this run; the picture may not fit")
    verdicts = judge_all(trace, network, chosen)
    with convert_write_errors(target):
        target.parent.mkdir(parents=True, exist_ok=True)
        if moments is None:
            draw_run(trace, network, verdicts, target, color_by=color_by)
        else:
            draw_strip(trace, network, verdicts, target, count=moments)
        give_to_user(target)
