"""A road network that is replaced while a run is executed."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import numpy as np

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.networks.importing.network_importing import import_network
from drivora_service.observations.trace_files.trace_file import read_trace
from drivora_service.runs.run_report import RunSpec, RunStatus
from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.validation import validate_data
from drivora_service.simulation.run_phase import BoardCell
from drivora_service.worker.performing import perform
from drivora_service.worker.progress_board import BoardReader, ProgressBoard
from drivora_service.worker.setup import WorkerSetup

NETWORK = shipped_networks() / "tee-town" / "tee-town.net.xml"


class ReplacingCells(np.ndarray[tuple[int], np.dtype[np.int64]]):
    """Cells of a board: with the first step of a run, a file takes the place of another."""

    files: tuple[Path, Path] | None = None

    def __setitem__(self, place: Any, value: Any) -> None:
        super().__setitem__(place, value)
        if self[BoardCell.STEP] >= 1 and self.files is not None:
            other, path = self.files
            self.files = None
            other.replace(path)


def test_its_run_has_no_result_and_the_next_one_has(tmp_path: Path) -> None:
    imported = tmp_path / "networks"
    path = import_network(NETWORK, "town", imported)
    document = copy.deepcopy(SCENARIO)
    document["map_region"]["town"] = "town"
    catalogue = NetworkCatalogue(shipped_networks(), imported)
    scenario = validate_data(document, catalogue, None).scenario
    setup = WorkerSetup(shipped_networks=shipped_networks(), imported_networks=imported)
    trace = tmp_path / "trace.parquet"
    spec = RunSpec(run_id="run", document=canonical_json(scenario), trace_path=str(trace))

    reader = BoardReader()
    board = ProgressBoard(reader.fileno())
    assert perform(spec, setup, board).status is RunStatus.FINISHED
    first = read_trace(trace).network_sha256

    other = tmp_path / "other.net.xml"
    other.write_text(NETWORK.read_text().replace("</net>", "<!-- again --></net>"))
    board.cells = cells = board.cells.view(ReplacingCells)
    cells[:] = 0
    cells.files = other, path
    report = perform(spec, setup, board)
    assert not other.exists()
    assert report.status is RunStatus.INFRASTRUCTURE_FAILED
    assert report.failure is not None
    assert report.failure.cause == "network_replaced"
    assert "'town' was replaced while the run was executed" in report.failure.message
    assert not trace.exists()

    assert perform(spec, setup, board).status is RunStatus.FINISHED
    assert read_trace(trace).network_sha256 != first
    reader.close()
