"""Light programmes: the times of a document, and agreement with SUMO step by step."""

from __future__ import annotations

import numpy as np
import pytest

from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.networks.road_network import SignalPhase, SignalProgram
from drivora_service.scenario.model import LightTimes, TrafficLights
from drivora_service.simulation.plans.light_programs import run_program, run_programs
from drivora_service.simulation.sumo import SumoWorld

TWO_STAGES = SignalProgram(
    id="j",
    program_id="0",
    offset=0.0,
    phases=tuple(
        SignalPhase(duration=duration, state=state)
        for duration, state in ((30, "GGrr"), (3, "yyrr"), (30, "rrGG"), (3, "rryy"))
    ),
)


def durations(times: LightTimes, program: SignalProgram = TWO_STAGES) -> list[float]:
    found: list[float] = np.diff(run_program(program, times).ends, prepend=0.0).tolist()
    return found


def test_without_times_the_network_keeps_its_own() -> None:
    assert durations(LightTimes()) == [30, 3, 30, 3]


def test_green_and_yellow_replace_every_stage_of_their_kind() -> None:
    assert durations(LightTimes(green=12, yellow=4)) == [12, 4, 12, 4]


def test_red_is_what_the_first_stage_sees_between_its_greens() -> None:
    found = durations(LightTimes(green=12, yellow=4, red=20))
    assert found == [12, 4, 16, 4]
    assert sum(found[2:]) == 20


def test_red_of_a_single_stage_is_its_dark_time() -> None:
    crossing = SignalProgram(
        id="x",
        program_id="0",
        offset=0.0,
        phases=tuple(
            SignalPhase(duration=d, state=s) for d, s in ((82, "GG"), (3, "yy"), (5, "rr"))
        ),
    )
    assert durations(LightTimes(red=11), crossing) == [82, 3, 11]


def test_stages_of_one_green_share_its_time() -> None:
    walkers_end_first = SignalProgram(
        id="w",
        program_id="0",
        offset=0.0,
        phases=tuple(
            SignalPhase(duration=duration, state=state)
            for duration, state in (
                (20, "GrG"), (5, "Grr"), (3, "yrr"), (2, "rrr"),
                (25, "rGr"), (3, "ryr"), (2, "rrr"),
            )
        ),
    )  # fmt: skip
    assert durations(LightTimes(green=10), walkers_end_first) == [8, 2, 3, 2, 10, 3, 2]
    found = durations(LightTimes(green=10, red=30), walkers_end_first)
    assert found == [8, 2, 3, 2, 23, 3, 2]
    assert sum(found[3:]) == 30


@pytest.mark.parametrize(
    "lights",
    [
        TrafficLights(),
        TrafficLights(times=LightTimes(green=7.3, yellow=2.2, red=12.0, offset=1.7)),
        TrafficLights(times=LightTimes(green=7.333, yellow=2.021, offset=-1.717)),
    ],
)
def test_sumo_shows_what_is_computed(lights: TrafficLights) -> None:
    network = NetworkCatalogue(shipped_networks()).get("signal-grid")
    assert network.programs
    world = SumoWorld(network.path, step_length=0.05, seed=1, slippery=False)
    world.open()
    programs = run_programs(network.programs, lights)
    world.set_programs(programs, 0.0)
    for k in range(2400):
        world.step()
        for program in programs:
            phase = int(program.phase_at(np.array([k * 0.05]))[0])
            assert world.light_state(program.id) == program.phases[phase].state, k * 0.05
