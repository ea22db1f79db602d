"""Leaving what an adversary has done on the worker's board, while the run goes on."""

from __future__ import annotations

from dataclasses import replace

from drivora_service.runs.run_report import RunSpec
from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.model import Scenario
from drivora_service.worker.progress_board import ProgressBoard
from drivora_service.worker.worker_messages import note_of_candidate


def leave_scenario(board: ProgressBoard | None, spec: RunSpec, scenario: Scenario) -> None:
    """Leaves the scenario so far in place of that of the run's candidate.

    So the scenario of a run that the process does not survive has what was done until then.

    Args:
        board: The worker's board; ``None``: nothing reads it.
        spec: The run, with what was made of its candidate.
        scenario: The scenario with what the adversary has done.
    """
    if board is not None and spec.prepared is not None:
        candidate = replace(spec.prepared, document=canonical_json(scenario))
        board.leave(note_of_candidate(candidate, spec.run_id))
