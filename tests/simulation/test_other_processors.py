"""Traces, verdicts and genes do not depend on the code that NumPy and BLAS choose by processor."""

from __future__ import annotations

import json
import platform

import pytest

from drivora_service.scenario.canonical import canonical_json
from tests.recomputation.mixed_runs import mixed_documents
from tests.simulation import test_golden
from tests.simulation.other_processor import compute, compute_elsewhere, probe

MIXED = (
    "several_egos-1",
    "several_egos-2",
    "several_egos-3",
    "in_traffic-7",
    "with_walkers-1",
    "at_stop_signs-1",
    "off_the_road-1",
)
"""Of `idm`, `idm-mobil`, `pdm-closed`, `plant-lite`, `ad-mlp`, `scripted` and SUMO's models."""


@pytest.mark.slow(seconds=20)
def test_another_processor_gives_the_same_bits() -> None:
    every = mixed_documents()
    # By JSON, as the other process gets them: numbers of NumPy would be written otherwise.
    documents = json.loads(json.dumps({name: every[name] for name in MIXED}))
    scenarios = {name: canonical_json(what) for name, what in test_golden.scenarios().items()}
    expected = json.loads(json.dumps(compute(documents, scenarios)))
    found, probed = compute_elsewhere(documents, scenarios)
    own = probe()
    assert probed["numpy"] != own["numpy"]
    assert platform.machine() != "x86_64" or probed["blas"] != own["blas"]
    assert {name for name, part in expected.items() if found[name] != part} == set()
    assert found == expected
