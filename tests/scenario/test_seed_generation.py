"""Seed generation: lengths, determinism, distinctness, and an end in every case."""

from __future__ import annotations

from dataclasses import replace

import pytest

from drivora_service.errors import InvalidDocument, NetworkError
from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.networks.routes.routing import plan_route
from drivora_service.scenario.checks.route_checks import route_points
from drivora_service.scenario.documents import ScenarioDocument, document_text
from drivora_service.scenario.seed_generation import generate_seeds
from drivora_service.scenario.validation import validate_document

TOWNS = ("tee-town", "signal-grid", "arterial", "roundabout", "highway", "rural")


def seeds(
    networks: NetworkCatalogue, town: str, *, seed: int = 1, count: int = 10
) -> list[ScenarioDocument]:
    generated = generate_seeds(
        networks.get(town), count=count, min_length=50.0, max_length=200.0, seed=seed, agent="idm"
    )
    return list(generated)


@pytest.mark.parametrize("town", TOWNS)
def test_seeds_are_valid_distinct_and_of_the_wanted_length(
    networks: NetworkCatalogue, town: str
) -> None:
    documents = seeds(networks, town)
    assert len({document_text(document) for document in documents}) == 10
    for document in documents:
        result = validate_document(document, networks, ("idm",))
        assert result.notes == ()
        route = plan_route(result.network, route_points(result.scenario.ego_vehicles[0].route))
        assert 50.0 <= route.length <= 200.0


def test_the_same_seed_gives_the_same_scenarios(networks: NetworkCatalogue) -> None:
    assert seeds(networks, "tee-town") == seeds(networks, "tee-town")
    assert seeds(networks, "tee-town") != seeds(networks, "tee-town", seed=2)
    assert seeds(networks, "tee-town", count=3) == seeds(networks, "tee-town")[:3]


def test_scenarios_have_seeds_of_their_own(networks: NetworkCatalogue) -> None:
    assert len({document.seed for document in seeds(networks, "tee-town")}) == 10


def test_it_ends_and_says_why(networks: NetworkCatalogue) -> None:
    network = networks.get("roundabout")
    generated = generate_seeds(
        network, count=5, min_length=20_000.0, max_length=21_000.0, seed=1, agent="idm"
    )
    with pytest.raises(NetworkError, match=r"found 0 of 5 .* Refused in all: .*: \d+"):
        list(generated)


def test_it_ends_when_the_network_is_used_up(networks: NetworkCatalogue) -> None:
    # Without junctions only the few roads that are longer than 300 m by themselves remain.
    network = networks.get("roundabout")
    apart = replace(network, lanes=tuple(replace(lane, connections=()) for lane in network.lanes))
    generated = generate_seeds(
        apart, count=1000, min_length=300.0, max_length=310.0, seed=1, agent="idm"
    )
    found: list[ScenarioDocument] = []
    with pytest.raises(NetworkError, match=r"found \d+ of 1000 .*too similar to an earlier seed"):
        found.extend(generated)
    assert 1 < len(found) < 1000


@pytest.mark.parametrize(
    ("options", "pointers"),
    [
        ({"count": 0}, ["/count"]),
        ({"min_length": 300.0}, ["/max_length"]),
        ({"min_length": float("nan")}, ["/min_length", "/max_length"]),
        ({"max_length": 1e9}, ["/max_length"]),
        ({"seed": -1}, ["/seed"]),
        ({"agent": "../x"}, ["/agent"]),
    ],
)
def test_options_that_cannot_be_met(
    networks: NetworkCatalogue, options: dict[str, object], pointers: list[str]
) -> None:
    chosen = {"count": 1, "min_length": 50.0, "max_length": 200.0, "seed": 1, "agent": "idm"}
    with pytest.raises(InvalidDocument) as caught:
        generate_seeds(networks.get("tee-town"), **{**chosen, **options})  # type: ignore[arg-type]  # parametrised
    assert [problem.pointer for problem in caught.value.problems] == pointers
