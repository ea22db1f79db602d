"""Smaller forms of scenarios with actors that join and weather that changes."""

from __future__ import annotations

import numpy as np

from drivora_service.scenario.documents import ScenarioDocument, parse_document
from drivora_service.suites.minimization import removals
from drivora_service.suites.minimization.edits import apply_edits
from drivora_service.suites.minimization.later_starts import Recording, later_starts

EGO = {"id": "ego", "model": "audi.tt", "route": [{"x": 0.0, "y": 0.0}, {"x": 90.0, "y": 0.0}]}


def changing() -> ScenarioDocument:
    return parse_document(
        {
            "map_region": {"town": "tee-town"},
            "ego_vehicles": [EGO],
            "npc_walkers": [
                {**walker, "model": "0001", "route": [{"x": 5.0, "y": 5.0}], "joins": True}
                for walker in (
                    {"id": "early", "start_time": 3.0},
                    {"id": "late", "start_time": 9.5},
                )
            ],
            "weather_changes": [
                {"time": 2.0, "weather": {"wetness": 10.0}},
                {"time": 4.0, "weather": {"wetness": 90.0, "fog_density": 5.0}},
                {"time": 9.0, "weather": {}},
            ],
        }
    )


def test_every_change_of_the_weather_and_every_value_of_it_may_go() -> None:
    document = changing()
    edits = {edit.label: edit for edit in removals.settings(document)}
    assert [label for label in edits if "weather_changes" in label] == [
        "without weather_changes 0",
        "without weather_changes 1",
        "without weather_changes 2",
        "without weather_changes 0 weather wetness",
        "without weather_changes 1 weather fog_density",
        "without weather_changes 1 weather wetness",
    ]
    less = apply_edits(
        document,
        [edits["without weather_changes 0"], edits["without weather_changes 1 weather wetness"]],
    )
    assert less is not None
    assert [change.time for change in less.weather_changes] == [4.0, 9.0]
    assert (less.weather_changes[0].weather.wetness, less.weather.wetness) == (0.0, 0.0)
    assert less.weather_changes[0].weather.fog_density == 5.0


def test_that_an_actor_joins_may_go() -> None:
    labels = [edit.label for edit in removals.details(changing())]
    assert "early without joins" in labels


def test_a_later_start_has_the_weather_and_the_actors_of_its_time() -> None:
    times = np.arange(0.0, 12.0, 0.1)
    here = np.tile([5.0, 5.0, 0.0, 0.0], (len(times), 1))
    recording = Recording(
        times=times, states={"ego": here, "early": here, "late": here}, has_lights=False
    )
    document = changing()
    (choices,) = later_starts(document, recording, failed_at=10.0)
    later = apply_edits(document, [choices[1]])
    assert later is not None
    assert choices[1].label == "begins 5 s later"
    assert (later.weather.wetness, later.weather.fog_density) == (90.0, 5.0)
    assert [(change.time, change.weather.wetness) for change in later.weather_changes] == [
        (4.0, 0.0)
    ]
    early, late = later.npc_walkers
    assert (early.joins, early.start_time) == (False, 0.0)
    assert (late.joins, late.start_time) == (True, 4.5)
