"""A picture of a run from its trace file."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path
from typing import Literal

from drivora_service.cli.embedded import network_catalogue
from drivora_service.cli.output import note
from drivora_service.errors import UnknownName
from drivora_service.observations.trace_file import read_trace
from drivora_service.oracles.built_in import judge_all
from drivora_service.oracles.catalogue import OracleCatalogue
from drivora_service.plotting.run_picture import draw_run
from drivora_service.plotting.strip import draw_strip
from drivora_service.settings import Settings


def draw_trace(
    path: Path,
    settings: Settings,
    target: Path,
    *,
    color_by: Literal["actor", "time"] = "actor",
    rules: Collection[str] = (),
    moments: int | None = None,
) -> None:
    """Judges a trace and draws it.

    Args:
        path: Of the trace.
        settings: Where networks are looked up.
        target: Where to write; ends in ``.svg`` or ``.png``.
        color_by: What the colour of the egos' trails says.
        rules: Names of the rules whose violations are marked; none: of all.
        moments: Draws a strip of so many moments rather than the whole run.

    Raises:
        StoreError: The file is no trace.
        UnknownName: Its network is not in the catalogue, or there is no such rule.
        OracleError: A package's oracle that is to judge cannot.
    """
    catalogue = OracleCatalogue()
    known = catalogue.names()
    for name in rules:
        if name not in known:
            raise UnknownName("rule", name, known)
    # Whoever names rules is not kept from a picture by others that are broken.
    oracles = [catalogue.oracle(name) for name in known if not rules or name in rules]
    trace = read_trace(path)
    network = network_catalogue(settings).get(trace.network)
    if network.sha256 != trace.network_sha256:
        note(f"network {network.name} has changed since this run; the picture may not fit")
    verdicts = judge_all(trace, network, oracles)
    target.parent.mkdir(parents=True, exist_ok=True)
    if moments is None:
        draw_run(trace, network, verdicts, target, color_by=color_by)
    else:
        draw_strip(trace, network, verdicts, target, count=moments)
