"""The light timings of a document act in an episode."""

from __future__ import annotations

import numpy as np
import pytest

from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import EgoCol, Light, TerminalEvent
from drivora_service.oracles.destination import Destination
from drivora_service.oracles.verdict import Outcome
from drivora_service.scenario.model import LightTimes, TrafficLights
from drivora_service.simulation.planning import plan_episode, signal_time
from tests.simulation.episodes import (
    ego,
    network,
    place,
    run,
    scenario,
    standing,
    start,
)

AVENUE = "grand_1_1"
"""112 m of signal-grid with a sidewalk beside it, straight east, 50 km/h."""


def test_light_times_of_a_document_are_shown_recorded_and_obeyed() -> None:
    lights = TrafficLights(times=LightTimes(green=6.0, yellow=2.0))
    what = scenario(
        ego(place(AVENUE, 60, on="signal-grid"), place("grand_2_1", 60, on="signal-grid")),
        on="signal-grid", traffic_lights=lights, seconds=45.0,
    )  # fmt: skip
    episode = start(what, mirrored=True)
    shown = []
    while not episode.done:
        shown.append(episode._sumo.light_state("b2"))
        episode.step()
    trace = episode.finish()
    column = trace.light_ids.index("b2")
    recorded = [trace.light_state_names[i] for i in trace.light_states[:, column]]
    differ = [k for k, state in enumerate(shown) if state != recorded[k]]
    assert not differ, (differ[:3], len(differ))
    changes = np.flatnonzero(np.diff(trace.light_states[:, column])) + 1
    # Walkers have green for four fifths of the cars' six seconds; behind the yellow all is red.
    assert set(np.diff(trace.times[changes]).round(2)) == {4.8, 1.2, 2.0}
    assert trace.ego_ends[0] is TerminalEvent.ARRIVED
    distance = trace.ego_values[:, 0, EgoCol.LIGHT_DISTANCE]
    crossing = int(np.argmax(distance < 0.0))
    assert distance[crossing] < 0.0
    assert trace.ego_lights[crossing, 0] != Light.RED


def test_a_junctions_own_times_and_offset_count_for_it_alone() -> None:
    town = "signal-grid"
    own = TrafficLights(junctions={"b2": LightTimes(green=4.0, yellow=2.0, offset=3.0)})
    traces = [
        run(
            scenario(
                ego(place("north_3_1", 20, on=town), place("north_3_1", 90, on=town)),
                on=town, traffic_lights=lights, seconds=20.0,
            ),
            standing(),
        )
        for lights in (TrafficLights(), own)
    ]  # fmt: skip
    plain, changed = (
        {
            light: [trace.light_state_names[i] for i in trace.light_states[:, column]]
            for column, light in enumerate(trace.light_ids)
        }
        for trace in traces
    )
    assert {light for light in plain if plain[light] != changed[light]} == {"b2"}


@pytest.mark.parametrize("offset", [0.0, 15.0, 30.0, 45.0])
def test_a_red_that_lasts_as_long_as_the_time_limit_does_not_use_it_up(offset: float) -> None:
    """42 s of red on a route of 54 m, for which an ego without lights has 48 s."""
    town = "signal-grid"
    lights = TrafficLights(times=LightTimes(green=10.0, yellow=3.0, red=42.0, offset=offset))
    what = scenario(
        ego(place(AVENUE, 85, on=town), place("grand_2_1", 12, on=town)),
        on=town, traffic_lights=lights, seconds=None,
    )  # fmt: skip
    plan = plan_episode(what, network(town))
    (own,) = plan.egos
    assert own.time_limit == pytest.approx(48.0, abs=6.0)
    assert signal_time(own.route, plan.programs) == pytest.approx(45.0, abs=0.5)
    assert plan.max_sim_time == pytest.approx(own.time_limit + 45.0, abs=0.5)
    trace = run(what)
    assert trace.ego_ends == (TerminalEvent.ARRIVED,)
    (verdict,) = Destination().judge(RunView(trace, network(town)))
    assert verdict.outcome is Outcome.PASSED


def test_an_ego_that_never_leaves_a_green_signal_runs_out_of_time() -> None:
    town = "signal-grid"
    lights = TrafficLights(times=LightTimes(green=10.0, yellow=3.0, red=42.0))
    what = scenario(
        ego(place(AVENUE, 85, on=town), place("grand_2_1", 12, on=town)),
        on=town, traffic_lights=lights, seconds=None, stuck_after=600.0,
    )  # fmt: skip
    trace = run(what, standing())
    assert trace.ego_ends == (TerminalEvent.TIME_LIMIT,)
    (verdict,) = Destination().judge(RunView(trace, network(town)))
    assert verdict.evidence["reason"] == "timeout"
