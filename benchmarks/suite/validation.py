"""The duration of validating a document."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager

from benchmarks.scenes import crowd_scene, mixed_scenarios
from benchmarks.suite.measurement import Measurement, Plan, Round, Sample, sample
from benchmarks.suite.step_cost import TOWN
from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.scenario.canonical import canonical_json, from_canonical
from drivora_service.scenario.documents import document_text
from drivora_service.scenario.exporting import to_document
from drivora_service.scenario.validation import validate_data


@contextmanager
def _open(plan: Plan) -> Iterator[Round]:
    networks = NetworkCatalogue(shipped_networks())
    agents = AgentCatalogue().names()
    network = networks.get(TOWN)
    counts = (11, 51) if plan.short else (11, 51, 201)
    cases = {
        "mixed scenarios, all kinds of actors": [
            document_text(to_document(scene)) for scene in mixed_scenarios(21, seed=1)
        ]
    }
    for actors in counts:
        scene = crowd_scene(network, npcs=actors - 1)
        cases[f"{actors} actors"] = [document_text(to_document(scene))]
    scenarios = {
        case: [validate_data(text, networks, agents).scenario for text in texts]
        for case, texts in cases.items()
    }
    times = 1 if plan.short else 10

    def once() -> Iterator[Sample]:
        for case, texts in cases.items():
            begun = time.process_time()
            for _ in range(times):
                for text in texts:
                    validate_data(text, networks, agents)
            validated = time.process_time()
            for _ in range(times):
                for scenario in scenarios[case]:
                    from_canonical(canonical_json(scenario))
            read = time.process_time()
            count = times * len(texts)
            yield sample(case, "validation", 1e3 * (validated - begun) / count, "ms")
            name = "writing and reading of the canonical form"
            yield sample(case, name, 1e3 * (read - validated) / count, "ms")

    yield once


VALIDATION = Measurement(
    name="validation",
    title="Validation of a document",
    about="Processor time of validating a document in its text form, with routing of all ways on "
    "networks that are loaded; and of what a worker does instead: the canonical form of the "
    "validated scenario, written and read.",
    open=_open,
)
