"""NPC vehicles from genes that stand, brake hard, change lanes quickly, and stay at their ends."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.observations.trace import Col
from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.model import NpcBehavior, NpcVehicle, RouteEnd
from drivora_service.scenario.validation import scenario_problems
from drivora_service.scenario.weather import weather_effects
from drivora_service.search.space.scenario_space import ScenarioSpace
from drivora_service.search.space.space_options import SpaceOptions, VehicleStarts
from tests.search.space.seeds import NETWORKS, SHIPPED, block_named, drawn, space_around
from tests.simulation.episodes import row_of, run, standing

ALL = SpaceOptions(
    vehicles=3, walkers=0, at_end=RouteEnd.STAY, max_wait=8.0, max_deceleration=10.0,
    max_lateral_acceleration=6.0,
)  # fmt: skip
TIMED = SpaceOptions(
    vehicles=3, walkers=0, weather=False, slice_time=3.0, min_speed=0.0, at_end=RouteEnd.STAY,
)  # fmt: skip
DT = 0.05


def with_genes(space: ScenarioSpace, values: FloatArray, **genes: float) -> FloatArray:
    """Values with some genes of the first vehicle set."""
    changed = values.copy()
    for name, value in genes.items():
        changed[block_named(space, "vehicle_0").index(name)] = value
    return changed


def middle(space: ScenarioSpace) -> FloatArray:
    """Every gene in the middle of its bounds."""
    return space.genes.clip(0.5 * (space.genes.lows + space.genes.highs))


def vehicle(space: ScenarioSpace, values: FloatArray) -> NpcVehicle:
    return space.scenario(values).npc_vehicles[0]


@pytest.mark.parametrize("behavior", [NpcBehavior.REACTIVE, NpcBehavior.REPLAY])
@pytest.mark.parametrize(
    "options", [ALL, TIMED, replace(TIMED, starts=VehicleStarts.FIXED, vehicles=2)]
)
@pytest.mark.parametrize("town", SHIPPED)
def test_every_drawn_candidate_is_valid(
    town: str, options: SpaceOptions, behavior: NpcBehavior
) -> None:
    space = space_around(town, replace(options, behavior=behavior))
    for number in range(8):
        scenario = space.scenario(drawn(space, number))
        assert not scenario_problems(scenario, NETWORKS, ["idm"])


@settings(max_examples=25)
@given(number=st.integers(0, 2**32 - 1), options=st.sampled_from([ALL, TIMED]))
def test_repaired_values_stay(number: int, options: SpaceOptions) -> None:
    space = space_around("arterial", options)
    values = space.repair(space.genes.sample(np.random.default_rng(number)) * 1.3)
    assert space.genes.within(values)
    assert np.array_equal(space.repair(values), values)
    assert canonical_json(space.scenario(values)) == canonical_json(space.scenario(values))


def test_without_the_options_vehicles_have_the_genes_that_they_had() -> None:
    space = space_around("arterial", SpaceOptions(vehicles=1, walkers=0, weather=False))
    names = [gene.name for gene in space.genes.genes]
    slices = [f"{name}_{k}" for name in ("speed", "lane", "along") for k in range(5)]
    assert names == ["present", "model", "path", "start", *slices]
    npc = vehicle(space, drawn(space, 1))
    assert (npc.at_end, npc.deceleration, npc.lateral_acceleration) == (RouteEnd.LEAVE, None, None)
    assert all(place.wait is None for place in npc.route)


def test_genes_of_the_driving_are_in_the_document() -> None:
    space = space_around("arterial", ALL)
    values = with_genes(
        space, middle(space), deceleration=9.25, lateral_acceleration=1.5,
        waits=1, wait_at=2, wait_time=4.5,
    )  # fmt: skip
    npc = vehicle(space, values)
    assert (npc.at_end, npc.deceleration, npc.lateral_acceleration) == (RouteEnd.STAY, 9.25, 1.5)
    assert [place.wait for place in npc.route if place.wait is not None] == [4.5]
    still = vehicle(space, with_genes(space, values, waits=0))
    assert all(place.wait is None for place in still.route)
    assert replace(npc, route=still.route) == still


def test_each_place_of_waiting_is_another_waypoint() -> None:
    space = space_around("highway", replace(ALL, vehicles=1))
    values = with_genes(space, middle(space), waits=1, wait_time=4.5)
    places = set()
    for at in range(5):
        route = vehicle(space, with_genes(space, values, wait_at=at)).route
        places |= {(place.x, place.y) for place in route if place.wait}
    assert len(places) == 5


def test_lanes_can_be_kept() -> None:
    options = SpaceOptions(vehicles=1, walkers=0, weather=False, lane_changes=False)
    space = space_around("highway", options)
    assert not block_named(space, "vehicle_0").indices("lane")
    timed = space_around("highway", replace(options, slice_time=3.0))
    assert not block_named(timed, "vehicle_0").indices("manoeuvre")
    for number in range(10):
        values = drawn(space, number)
        path = space.paths[int(values[block_named(space, "vehicle_0").index("path")])].path
        for place in vehicle(space, values).route:
            assert path.place_of(place.x, place.y)[1] < 0.6


# --- slices of time ---


def timed_space(town: str = "highway") -> ScenarioSpace:
    """One vehicle ahead of the ego."""
    return space_around(
        town,
        SpaceOptions(
            vehicles=1, walkers=0, weather=False, slice_time=3.0, min_speed=0.0,
            starts=VehicleStarts.FIXED, at_end=RouteEnd.STAY,
        ),
    )  # fmt: skip


def slices(space: ScenarioSpace, speeds: list[float], manoeuvres: list[int]) -> FloatArray:
    values = middle(space)
    genes = {f"speed_{k}": speed for k, speed in enumerate(speeds)}
    genes |= {f"manoeuvre_{k}": float(one) for k, one in enumerate(manoeuvres)}
    return with_genes(space, values, **genes)


def arcs(space: ScenarioSpace, npc: NpcVehicle) -> list[float]:
    """Arc lengths of the waypoints on the vehicle's path, metres from its start."""
    path = space._vehicles[0].place(middle(space)).path.path
    found = [path.place_of(place.x, place.y)[0] for place in npc.route]
    return [s - found[0] for s in found]


def test_a_slice_of_time_leads_as_far_as_its_speed() -> None:
    space = timed_space()
    npc = vehicle(space, slices(space, [10.0, 8.0, 6.0, 8.0, 10.0], [0] * 5))
    assert arcs(space, npc)[:6] == pytest.approx([0, 30, 54, 72, 96, 126], abs=1.5)
    assert [place.speed for place in npc.route[1:6]] == [10.0, 8.0, 6.0, 8.0, 10.0]


def test_a_slice_without_speed_is_stood_through() -> None:
    space = timed_space()
    npc = vehicle(space, slices(space, [10.0, 0.0, 0.0, 8.0, 10.0], [0] * 5))
    assert [place.wait for place in npc.route] == [None, 6.0, None, None, None]
    npc = vehicle(space, slices(space, [0.0, 10.0, 8.0, 8.0, 0.0], [0] * 5))
    assert [place.wait for place in npc.route] == [3.0, None, None, 3.0]


def test_a_vehicle_that_never_drives_is_parked() -> None:
    space = timed_space()
    npc = vehicle(space, slices(space, [0.0] * 5, [0] * 5))
    (place,) = npc.route
    assert place.wait is None
    scenario = space.scenario(slices(space, [0.0] * 5, [0] * 5))
    assert not scenario_problems(scenario, NETWORKS, ["idm"])


def test_manoeuvres_add_up_from_lane_to_lane() -> None:
    space = timed_space("signal-grid")
    path = space._vehicles[0].place(middle(space)).path.path

    def lanes(*manoeuvres: int) -> list[int]:
        npc = vehicle(space, slices(space, [12.0] * 5, list(manoeuvres)))
        sides = []
        for place in npc.route[1:6]:
            s, off = path.place_of(place.x, place.y)
            here = path.at(s)
            left = np.sin(here.yaw) * (here.x - place.x) + np.cos(here.yaw) * (place.y - here.y)
            sides.append(0 if off < 1.0 else int(np.sign(left)))
        return sides

    left = bool(lanes(1, 0, 0, 0, 0)[0])
    one, back = (1, 2) if left else (2, 1)
    there = 1 if left else -1
    assert lanes(0, 0, 0, 0, 0) == [0, 0, 0, 0, 0]
    assert lanes(one, 0, 0, back, 0) == [there, there, there, 0, 0]
    assert lanes(0, one, one, back, 0)[1:4] == [there, there, 0]


# --- in real simulations ---


@pytest.mark.slow
@pytest.mark.parametrize("town", ["arterial", "highway", "tee-town"])
def test_drawn_vehicles_brake_within_the_grip_and_stay(town: str) -> None:
    options = replace(ALL, behavior=NpcBehavior.REPLAY)
    space = space_around(town, options)
    stood = hard = stayed = 0
    for number in range(12):
        scenario = replace(space.scenario(drawn(space, number)), max_sim_time=60.0)
        trace = run(scenario, standing())
        friction = weather_effects(scenario.weather).friction
        for npc in scenario.npc_vehicles:
            row = row_of(trace, npc.id)
            assert trace.present[:, row].all()
            points = trace.states[:, row, [Col.X, Col.Y]]
            speed = np.hypot(*np.diff(points, axis=0).T) / DT
            # Over four steps: positions follow lines from point to point.
            braking = float((speed[:-4] - speed[4:]).max()) / (4 * DT)
            assert braking < friction * 9.81 + 0.35
            hard += braking > 5.0
            still = speed < 1e-6
            stayed += bool(still[-20:].all())
            stood += bool(
                (still[:-40] & ~still[-1]).any() or (np.diff(still.astype(int)) < 0).any()
            )
    assert hard >= 3
    assert stayed >= 12
    assert stood >= 3
