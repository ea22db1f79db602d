"""The reaction time of the intelligent-driver agent, measured by what the ego does."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.agents.idm.agent import IdmAgent
from drivora_service.agents.idm.reaction import MOST_TURNING, ReactionDelay, foresee
from drivora_service.agents.interface import Observation
from drivora_service.errors import DrivoraError
from drivora_service.observations.trace import Light, Trace
from drivora_service.observations.trace_files.trace_hash import trace_sha256
from drivora_service.scenario.model import BackgroundTraffic, Scenario, Waypoint
from tests.agents.driving import red_light_ahead
from tests.simulation.episodes import ROAD, car, ego, place, run, scenario, speeds, track, walker

HIGHWAY = "highway"
BRAKES_AT = 90.0
"""Metres that the one ahead drives at 15 m/s before it brakes."""


def behind_one_that_brakes(gap: float = 40.0) -> Scenario:
    """An ego behind a vehicle that drives at 15 m/s for 6 s, and then brakes to a standstill."""

    def at(s: float, speed: float | None = None) -> Waypoint:
        return place("eb_1_1", s, on=HIGHWAY, speed=speed)

    start = 20.0 + gap
    return scenario(
        ego(at(20.0), place("eb_a_decelerate_0", 220, on=HIGHWAY), initial_speed=15.0),
        npc_vehicles=(
            car(
                at(start, 15.0),
                at(start + BRAKES_AT, 15.0),
                at(start + BRAKES_AT + 15.0, 0.0),
                behavior="replay",
            ),
        ),
        on=HIGHWAY,
        seconds=20.0,
    )


def way_driven(trace: Trace, actor: str) -> NDArray[np.float64]:
    """Returns the metres of each step, by the places of the centre."""
    moved: NDArray[np.float64] = np.hypot(*np.diff(track(trace, actor), axis=0).T)
    return moved


def reacts_after(reaction_time: float) -> float:
    """Returns the seconds from the first braking of the one ahead to that of the ego.

    The ego brakes from the moment on in which its way differs from that behind one that never
    brakes.
    """
    what = behind_one_that_brakes()
    (npc,) = what.npc_vehicles
    first, second, _ = npc.route
    on = replace(npc, route=(first, second, place("eb_1_1", 300, on=HIGHWAY, speed=15.0)))
    braking = run(what, IdmAgent(reaction_time=reaction_time))
    steady = run(replace(what, npc_vehicles=(on,)), IdmAgent(reaction_time=reaction_time))
    rows = min(len(braking.times), len(steady.times)) - 1
    begins = [
        int(np.argmax(np.abs(ways[0][:rows] - ways[1][:rows]) > 1e-6))
        for ways in (
            [way_driven(trace, actor) for trace in (braking, steady)] for actor in ("npc", "ego")
        )
    ]
    assert min(begins) > 20
    return float(begins[1] - begins[0]) * braking.step_length


@pytest.mark.parametrize("reaction_time", [0.05, 0.5, 1.0, 1.03, 2.5])
def test_it_notices_later_by_its_reaction_time_that_another_brakes(reaction_time: float) -> None:
    late = reacts_after(reaction_time) - reacts_after(0.0)
    assert late == pytest.approx(math.ceil(reaction_time / 0.05 - 1e-9) * 0.05)


def test_without_a_reaction_time_it_drives_as_before() -> None:
    """The golden runs are those of an agent without one; a step of delay would change them."""
    what = behind_one_that_brakes()
    usual = trace_sha256(run(what))
    assert usual == trace_sha256(run(what, IdmAgent(reaction_time=0.0)))
    assert usual != trace_sha256(run(what, IdmAgent(reaction_time=0.05)))


def test_a_reaction_time_changes_nothing_behind_a_steady_vehicle_or_alone() -> None:
    at = [place("harbour_0_0", s, speed=6.0) for s in (60, 200)]
    ahead = car(*at, behavior="replay")
    for others in ((), (ahead,)):
        what = scenario(
            ego(place("harbour_0_0", 20), place("harbour_0_0", 220), initial_speed=6.0),
            npc_vehicles=others,
            seconds=15.0,
        )
        slow, quick = (run(what, IdmAgent(reaction_time=t)) for t in (1.5, 0.0))
        rows = slice(None, min(len(slow.times), len(quick.times), 300))
        ways = [track(trace, "ego")[rows] for trace in (slow, quick)]
        assert np.abs(ways[0] - ways[1]).max() < 0.1


def test_a_slow_reaction_crashes_where_a_quick_one_does_not() -> None:
    quick, slow = (
        run(behind_one_that_brakes(), IdmAgent(reaction_time=seconds)) for seconds in (0.0, 2.0)
    )
    assert not quick.contacts
    assert [slow.actors[contact.other].id for contact in slow.contacts] == ["npc"]


def test_with_a_second_it_hits_a_walker_for_whom_it_stops_without() -> None:
    out = walker(place(ROAD, 62, right=6.0, speed=2.0), place(ROAD, 62, right=-6.0), start_time=2.5)
    what = scenario(
        ego(place(ROAD, 10), place(ROAD, 110), initial_speed=10.0),
        npc_walkers=(out,),
        seconds=14.0,
    )
    hit = [bool(run(what, IdmAgent(reaction_time=t)).contacts) for t in (0.0, 0.5, 1.0)]
    assert hit == [False, False, True]


def test_who_steps_out_is_noticed_later() -> None:
    stops = []
    for reaction_time in (0.0, 1.0):
        # A walker comes into the road from beside it, 30 m ahead, after two seconds.
        out = walker(
            place(ROAD, 62, right=6.0, speed=1.5), place(ROAD, 62, right=-6.0), start_time=2.0
        )
        what = scenario(
            ego(place(ROAD, 10), place(ROAD, 110), initial_speed=8.0),
            npc_walkers=(out,),
            seconds=6.0,
        )
        alone = way_driven(run(replace(what, npc_walkers=()), IdmAgent()), "ego")
        moved = way_driven(run(what, IdmAgent(reaction_time=reaction_time)), "ego")
        rows = min(len(alone), len(moved))
        stops.append(int(np.argmax(alone[:rows] - moved[:rows] > 1e-6)))
    assert stops[1] - stops[0] == 20


def test_a_light_that_turns_is_noticed_later() -> None:
    starts = []
    for reaction_time in (0.0, 1.0):
        trace = run(red_light_ahead(), IdmAgent(reaction_time=reaction_time))
        speed, lights = speeds(trace, "ego"), trace.ego_lights[:, 0]
        stood = int(np.flatnonzero(speed < 0.1)[-1])
        green = int(np.flatnonzero(lights[:stood] == Light.RED)[-1]) + 1
        starts.append((stood - green) * 0.05)
    assert starts[1] - starts[0] == pytest.approx(1.0, abs=0.06)


def test_a_reaction_time_gives_the_same_run_each_time() -> None:
    what = replace(red_light_ahead(), background_traffic=BackgroundTraffic(count=25), seed=4)
    hashes = {trace_sha256(run(what, IdmAgent(reaction_time=0.7))) for _ in range(2)}
    assert len(hashes) == 1


@pytest.mark.parametrize("written", [-0.1, 3.1, "soon"])
def test_reaction_times_have_limits(written: object) -> None:
    with pytest.raises(DrivoraError, match="reaction_time"):
        AgentCatalogue().create("idm", {"reaction_time": written})


def test_memory_of_others_grows_and_is_kept() -> None:
    """More actors than there is room for at first, as they come; the past stays as it was."""
    delay = ReactionDelay(0.1, 0.05, 2.0)

    def seen(step: int, count: int) -> Observation:
        states = np.zeros((count, 9))
        states[:, 0] = 100.0 * step + np.arange(count)
        return Observation(
            time=0.05 * step,
            step=step,
            ego=np.zeros(9),
            objects=states,
            object_sizes=np.full((count, 2), float(step)),
            object_kinds=np.full(count, step % 3),
            object_ids=np.arange(count),
        )

    counts = [3, 10, 40, 90, 0, 7]
    for step, count in enumerate(counts):
        past = max(step - 2, 0)
        found = delay(seen(step, count))
        assert (found.time, found.step) == (0.05 * step, step)
        expected = seen(past, counts[past])
        assert found.objects == pytest.approx(expected.objects)
        assert found.object_sizes == pytest.approx(expected.object_sizes)
        assert found.object_kinds.tolist() == expected.object_kinds.tolist()
        assert found.object_ids.tolist() == expected.object_ids.tolist()


def test_others_are_expected_to_go_on_as_they_did() -> None:
    """A quarter of a circle of 20 m, a walker who does not turn, and one that spins."""
    rate = math.pi / 4.0
    states = np.zeros((3, 9))
    states[:, 3] = 20.0 * rate, 1.0, 1.0
    states[:, 7] = rate, rate, 99.0
    found = np.zeros((3, 9))
    foresee(states, np.array([0, 1, 0]), 3, 2.0, found)
    assert found[0, :5] == pytest.approx([20.0, 20.0, math.pi / 2.0, 0.0, 20.0 * rate])
    assert found[1, :5] == pytest.approx([2.0, 0.0, 0.0, 1.0, 0.0])
    assert found[2, 2] == pytest.approx(2.0 * MOST_TURNING)
