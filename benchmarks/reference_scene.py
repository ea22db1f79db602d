"""Writes a scene with the path that an ADS takes in it.

    python -m benchmarks.reference_scene SCENE --agent idm-mobil --out FILE

Every ego of the written scene has the ADS as its agent, and as its ``reference_path`` the path that
it takes in the scene as it is. So the oracle ``non_optimal_decision`` judges the runs of every
method on it, not only those of Decictor.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from pathlib import Path
from typing import Any

from benchmarks.search_scenes import catalogues
from drivora_service.errors import DrivoraError
from drivora_service.networks.catalogue import shipped_networks
from drivora_service.observations.reference_path import recorded_path
from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import TerminalEvent
from drivora_service.observations.trace_files.trace_file import read_trace
from drivora_service.runs.candidate import Reference
from drivora_service.runs.run_report import RunSpec, RunStatus
from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.documents import document_text
from drivora_service.scenario.exporting import to_document
from drivora_service.scenario.model import Scenario
from drivora_service.scenario.validation import validate_data
from drivora_service.search.space.keeping_clear import with_reference
from drivora_service.worker.performing import perform
from drivora_service.worker.setup import WorkerSetup


class NoReferenceError(DrivoraError):
    """The ADS takes no path in a scene with which others could be compared."""


def simulate_scene(scenario: Scenario) -> RunView:
    """Returns a view of the run of a scenario.

    Raises:
        NoReferenceError: It was not simulated, or an ego did not arrive.
    """
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "trace.parquet"
        spec = RunSpec(run_id="reference", document=canonical_json(scenario), trace_path=str(path))
        report = perform(spec, WorkerSetup(shipped_networks=shipped_networks()))
        if report.status is not RunStatus.FINISHED:
            raise NoReferenceError(f"the scene was not simulated: {report.failure}")
        trace = read_trace(path)
    view = RunView(trace, catalogues().networks.get(trace.network))
    for ego in view.egos:
        if ego.end is not TerminalEvent.ARRIVED:
            raise NoReferenceError(
                f"ego {ego.id!r} does not arrive ({ego.end.value.replace('_', ' ')}), so that "
                "there is no path to be compared with; choose another scene or ADS"
            )
    return view


def add_driven_paths(content: dict[str, Any], agent: str) -> str:
    """Returns the text of a scene's document with an ADS and the paths that it takes.

    Raises:
        NoReferenceError: As `driven`.
    """
    for ego in content["ego_vehicles"]:
        ego["agent"] = {"name": agent}
    agents = frozenset(catalogues().agents.names())
    scenario = validate_data(content, catalogues().networks, agents).scenario
    paths = tuple(
        tuple(map(tuple, recorded_path(ego).tolist())) for ego in simulate_scene(scenario).egos
    )
    return document_text(to_document(with_reference(scenario, Reference(paths=paths))))


def main() -> None:
    """Reads and writes."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene", type=Path)
    parser.add_argument("--agent", required=True)
    parser.add_argument("--out", type=Path, required=True)
    options = parser.parse_args()
    try:
        text = add_driven_paths(json.loads(options.scene.read_text()), options.agent)
    except NoReferenceError as error:
        raise SystemExit(str(error)) from None
    options.out.write_text(text)


if __name__ == "__main__":
    main()
