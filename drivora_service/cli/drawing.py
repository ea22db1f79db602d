"""A picture of a run from its trace file."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from drivora_service.cli.embedded import network_catalogue
from drivora_service.cli.output import note
from drivora_service.observations.trace_file import read_trace
from drivora_service.oracles.catalogue import default_oracles, judge_all
from drivora_service.plotting.run_picture import draw_run
from drivora_service.settings import Settings


def draw_trace(
    path: Path, settings: Settings, target: Path, *, color_by: Literal["actor", "time"] = "actor"
) -> None:
    """Judges a trace and draws it.

    Raises:
        StoreError: The file is no trace.
        UnknownName: Its network is not in the catalogue.
    """
    trace = read_trace(path)
    network = network_catalogue(settings).get(trace.network)
    if network.sha256 != trace.network_sha256:
        note(f"network {network.name} has changed since this run; the picture may not fit")
    verdicts = judge_all(trace, network, default_oracles())
    target.parent.mkdir(parents=True, exist_ok=True)
    draw_run(trace, network, verdicts, target, color_by=color_by)
