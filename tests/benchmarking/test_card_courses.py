from __future__ import annotations

import hashlib

import pytest

from drivora_service.benchmarking.card_courses import COURSES, RUNS, VERSION, benchmark_scenarios
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.scenario.documents import document_text

HASHES = {1: "ab8a46145ccf7b87a16e40c5d77c6f4656b8bdb062e0eb539e26e169ad80c3e1"}


@pytest.fixture(scope="module")
def networks() -> NetworkCatalogue:
    return NetworkCatalogue(shipped_networks())


def test_scenarios_of_a_version_never_change(networks: NetworkCatalogue) -> None:
    texts = "".join(
        document_text(scenario.document) for scenario in benchmark_scenarios(networks, RUNS)
    )
    assert hashlib.sha256(texts.encode()).hexdigest() == HASHES[VERSION], (
        "cards compare only between equal scenarios: give the benchmark a new version"
    )


def test_fewer_scenarios_are_the_first_of_more(networks: NetworkCatalogue) -> None:
    few, more = tuple(benchmark_scenarios(networks, 2)), tuple(benchmark_scenarios(networks, 4))
    assert few == tuple(scenario for scenario in more if scenario.number <= 2)
    assert [scenario.network for scenario in few] == [c.network for c in COURSES for _ in range(2)]
    assert all(scenario.document.background_traffic is not None for scenario in few)
