"""Single reductions of the shipped examples: valid, smaller, and never of the ADS under test."""

from __future__ import annotations

import random
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.scenario.documents import ScenarioDocument
from drivora_service.scenario.exporting import to_document
from drivora_service.scenario.validation import validate_data
from drivora_service.suites.minimization import removals
from drivora_service.suites.minimization.edits import Edit, apply_edits, content_of
from drivora_service.suites.minimization.reduction_search import Proposal, Reductions, State
from drivora_service.suites.minimization.rounding import DECIMALS, make_roundings, numbers
from drivora_service.suites.minimization.scenario_sizes import differences, size_of
from drivora_service.suites.minimization.shortening import (
    Failure,
    less_time,
    route_lengths,
    sooner_ends,
)
from tests.suites.minimization.synthetic import checker

EXAMPLES = Path(__file__).parents[3] / "openscenario_schemas" / "examples"
FILES = (
    *sorted(EXAMPLES.glob("*.json")),
    *sorted((EXAMPLES / "responsibility").glob("*.json"))[::8],
)
NETWORKS = NetworkCatalogue(shipped_networks())


def read(path: Path) -> ScenarioDocument:
    """An example as the scenario of a run: in the network's plane."""
    return to_document(validate_data(path.read_bytes(), NETWORKS, None).scenario)


def state(document: ScenarioDocument) -> State:
    ego = document.ego_vehicles[0].route[0]
    failure = Failure(time=4.2, location=(ego.x, ego.y), sim_time_s=60.0)
    return State(document=document, failure=failure)


def single(document: ScenarioDocument) -> tuple[Proposal, ...]:
    network = checker().network_of(document)
    ego = document.ego_vehicles[0].id
    return Reductions(ego=ego, network=network).single(state(document))


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_each_single_reduction_is_a_smaller_document_or_none(path: Path) -> None:
    document = read(path)
    proposals = single(document)
    assert len(proposals) > 5
    ego = document.ego_vehicles[0]
    runnable = 0
    luck = random.Random(path.stem)
    for proposal in luck.sample(proposals, min(len(proposals), 60)):
        less = proposal.document()
        if less is None:
            continue
        assert less != document
        assert less.ego_vehicles[0].id == ego.id
        assert less.ego_vehicles[0].agent == ego.agent
        assert less.map_region.town == document.map_region.town
        assert less.step_length == document.step_length
        assert len(proposal.label) > 3
        runnable += checker()(less) is not None
    assert runnable > 0


@settings(max_examples=30)
@given(st.sampled_from(FILES), st.randoms(use_true_random=False))
def test_any_number_of_parts_can_be_left_out_at_once(path: Path, luck: random.Random) -> None:
    """What is left is what an independent count says, whatever the order of the edits is."""
    document = read(path)
    ego = document.ego_vehicles[0].id
    edits = [
        *removals.actors(document, ego),
        *removals.settings(document),
        *removals.waypoints(document),
        *removals.details(document),
    ]
    chosen = luck.sample(edits, luck.randint(0, len(edits)))
    shuffled = luck.sample(chosen, len(chosen))
    less = apply_edits(document, chosen)
    assert less == apply_edits(document, shuffled)
    if less is None:
        return
    gone = {edit.label.rpartition(" ")[2] for edit in removals.actors(document, ego)
            if edit in chosen}  # fmt: skip
    kept = {
        actor["id"]
        for key in removals.ACTORS
        for actor in content_of(document).get(key, ())
        if actor["id"] not in gone
    }
    assert kept == {
        actor["id"] for key in removals.ACTORS for actor in content_of(less).get(key, ())
    }


@pytest.mark.parametrize("path", FILES[:8], ids=lambda path: path.stem)
@pytest.mark.parametrize("decimals", DECIMALS)
def test_rounded_numbers_have_so_many_decimals(path: Path, decimals: int) -> None:
    document = read(path)
    edits = make_roundings(document, decimals)
    less = apply_edits(document, edits)
    assert less is not None or decimals == 0
    if less is None:
        return
    for _, value in numbers(content_of(less)):
        _, _, digits = repr(value).partition(".")
        assert digits == "0" or len(digits) <= decimals
        assert repr(value) != "-0.0"
    assert make_roundings(less, decimals) == []


def test_routes_end_behind_the_failure_and_get_shorter() -> None:
    document = read(EXAMPLES / "signalised-grid.json")
    network = checker().network_of(document)
    (before,) = route_lengths(document, network).values()
    (choices,) = sooner_ends(document, state(document).failure, network)
    lengths: list[float] = []
    for edit in choices:
        less = apply_edits(document, [edit])
        assert less is not None
        assert checker()(less) is not None
        lengths += route_lengths(less, network).values()
    assert lengths == pytest.approx([5.0, 10.0, 20.0, 40.0, 80.0], abs=2.0)
    assert max(lengths) < before


def test_the_episode_ends_after_the_failure_and_not_before() -> None:
    document = read(EXAMPLES / "signalised-grid.json")
    failure = Failure(time=12.3, location=None, sim_time_s=16.0)
    (choices,) = less_time(document, failure)
    assert values(choices) == [14.0, 15.0]
    limited = document.model_copy(update={"max_sim_time": 90.0})
    ((without,),) = less_time(limited, failure)
    shorter = apply_edits(limited, [without])
    assert shorter is not None
    assert shorter.max_sim_time is None
    assert less_time(document, Failure(time=None, location=None, sim_time_s=60.0)) == []


def values(edits: list[Edit]) -> list[object]:
    return [value for edit in edits for _, value in edit.changes]


def test_sizes_and_differences_are_those_of_the_documents() -> None:
    document = read(EXAMPLES / "signalised-grid.json")
    network = checker().network_of(document)
    less = apply_edits(
        document, [*removals.settings(document), *removals.actors(document, "ego_0")]
    )
    assert less is not None
    size = size_of(document, network, sim_time_s=61.5)
    assert (size.actors, size.egos, size.background) == (31, 1, 30)
    assert (size.waypoints, size.sim_time_s) == (2, 61.5)
    assert size.route_m == pytest.approx(282.0, abs=5.0)
    smaller = size_of(less, network, sim_time_s=61.5)
    assert (smaller.actors, smaller.settings) == (1, 0)
    # 285.1, 221.62, 180, 128.38, 91.5, -90, 1; 25, 3; 12, 3, 5.
    assert (size.digits, smaller.digits) == (30, 23)
    assert differences(document, less, network) == (
        "Background traffic removed.",
        "Settings back at their defaults: traffic_lights.green_time, traffic_lights.yellow_time, "
        "traffic_lights.junctions.c3, seed.",
        "The numbers have 23 digits instead of 30.",
    )


def test_patches_are_left_out_and_rounded_as_actors_are() -> None:
    plain = read(EXAMPLES / "signalised-grid.json")
    place = plain.ego_vehicles[0].route[0]
    ice = {
        "id": "ice",
        "location": {"x": place.x, "y": place.y, "yaw": 12.345, "z": 0.0},
        "length": 12.3456,
        "width": 3.0,
        "friction": 0.123456,
    }
    document = ScenarioDocument.model_validate({**content_of(plain), "friction_patches": [ice]})
    ego = document.ego_vehicles[0].id
    (gone,) = (edit for edit in removals.actors(document, ego) if "ice" in edit.label)
    assert apply_edits(document, [gone]) == plain
    labels = [edit.label for edit in removals.details(document)]
    assert {"ice without location yaw", "ice without location z"} <= set(labels)
    assert not any("friction" in label or "length" in label for label in labels)
    (friction,) = (
        edit for edit in make_roundings(document, 2) if edit.changes[0][0][-1] == "friction"
    )
    rounder = apply_edits(document, [friction])
    assert rounder is not None
    assert rounder.friction_patches[0].friction == 0.12
    network = checker().network_of(document)
    assert size_of(document, network, sim_time_s=9.0).patches == 1
    assert size_of(plain, network, sim_time_s=9.0).patches == 0
    assert "1 slippery patch removed: ice." in differences(document, plain, network)
