"""The cost of a step by component."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from benchmarks.run_cost import STEP_PARTS, Parts, take_apart
from benchmarks.scenes import crowd_scene
from benchmarks.suite.measurement import Measurement, Plan, Round, Sample, sample
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.scenario.canonical import canonical_json

TOWN = "highway"
"""The shipped network with the longest lanes, which has room for 200 vehicles."""
_SHORT_S = 10.0


@contextmanager
def _open(plan: Plan) -> Iterator[Round]:
    network = NetworkCatalogue(shipped_networks()).get(TOWN)
    seconds = _SHORT_S if plan.short else 60.0
    steps = round(seconds * 20)
    documents = {
        actors: canonical_json(crowd_scene(network, npcs=actors - 1, seconds=seconds))
        for actors in ((1, 11, 51) if plan.short else (1, 11, 51, 101, 201))
    }
    trace = plan.folder / "trace.parquet"
    for document in documents.values():
        take_apart(document, network, Parts(), trace)

    def once() -> Iterator[Sample]:
        for actors, document in documents.items():
            parts = Parts()
            take_apart(document, network, parts, trace)
            for name, label in STEP_PARTS.items():
                value = 1e3 * parts.median_ms(name) / steps
                yield sample(f"{actors} actors", label, value, "us")

    yield once


STEP_COST = Measurement(
    name="step-cost",
    title="Cost of a step by component",
    about="Processor time of one step of 0.05 s: one ego (`idm`) and reactive NPCs, spread over "
    f"the lanes of `{TOWN}`, all there for the whole run of 60 s (short form: 10 s). SUMO drives "
    "none of them. Components are shares of wall time.",
    open=_open,
)
