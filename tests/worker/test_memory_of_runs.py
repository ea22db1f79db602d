"""Nothing holds the trace of a run when the run is over."""

from __future__ import annotations

import gc

import pytest

from drivora_service.feedback.catalogue import BUILT_IN
from drivora_service.feedback.measurement import FeedbackChoice
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.observations.run_view import EgoView, RunView
from drivora_service.observations.trace import Trace
from drivora_service.runs.run_report import RunSpec, RunStatus
from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.seed_generation import generate_seeds
from drivora_service.scenario.validation import validate_document
from drivora_service.worker.performing import perform
from drivora_service.worker.setup import WorkerSetup
from drivora_service.worker.worker_warm_up import warm_up


def held() -> list[object]:
    gc.collect()
    return [found for found in gc.get_objects() if isinstance(found, Trace | EgoView | RunView)]


@pytest.mark.slow
def test_nothing_holds_the_trace_of_a_run_that_is_over() -> None:
    setup = WorkerSetup(shipped_networks=shipped_networks(), installed_oracles=False)
    networks = NetworkCatalogue(shipped_networks())
    (seed,) = generate_seeds(
        networks.get("tee-town"), count=1, min_length=50, max_length=80, seed=3, agent="idm"
    )
    document = canonical_json(validate_document(seed, networks, ("idm",)).scenario)
    before = held()
    # Runs of several agents, and one into an obstacle, whose avoidability is judged.
    warm_up(setup)
    for plugin in BUILT_IN:
        choice = FeedbackChoice(name=plugin.name)
        report = perform(RunSpec(run_id="run", document=document, feedback=choice), setup)
        assert report.status is RunStatus.FINISHED, report.failure
        assert report.measurement is not None
    known = {id(found) for found in before}
    assert [type(found).__name__ for found in held() if id(found) not in known] == []
