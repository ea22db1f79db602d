from __future__ import annotations

import copy
from typing import Any

import pytest

from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.document.campaign_reading import read_campaign


def placed(content: dict[str, Any], catalogues: Catalogues) -> list[str]:
    """The notes that begin with a place."""
    return [note for note in read_campaign(content, catalogues).notes if note.startswith("/")]


@pytest.mark.parametrize(
    ("space", "begin"),
    [
        ({"min_speed": 20.0}, "/space/min_speed: every NPC vehicle wants 20 m/s (72 km/h) or more"),
        ({"max_speed_factor": 3.0}, "/space/max_speed_factor: NPC vehicles want up to 3 times the"),
        ({"max_deceleration": 11.0}, "/space/max_deceleration: 11 m/s²; a dry road allows 9.81"),
        (
            {"walkers": 1, "max_walker_delay": 500.0},
            "/space/max_walker_delay: 500 s (8.33 min) for walkers; every run has ended by 40 s",
        ),
        (
            {"egos": 2, "max_ego_delay": 40.0},
            "/space/max_ego_delay: 40 s for egos; every run has ended by 40 s; times are in sec",
        ),
        ({"slice_time": 50.0}, "/space/slice_time: 50 s for a vehicle in its first slice; every"),
    ],
)
def test_ranges_far_from_what_the_scene_allows_are_noted(
    content: dict[str, Any], catalogues: Catalogues, space: dict[str, float], begin: str
) -> None:
    content["scenario"]["max_sim_time"] = 40.0
    content["space"] = {"vehicles": 2, "walkers": 0, "weather": False, **space}
    (note,) = placed(content, catalogues)
    assert note.startswith(begin)


def test_ranges_of_what_does_not_vary_are_not_noted(
    content: dict[str, Any], catalogues: Catalogues
) -> None:
    content["scenario"]["max_sim_time"] = 40.0
    space = {"min_speed": 20.0, "max_speed_factor": 3.0, "max_walker_delay": 500.0}
    content["space"] = {"vehicles": 0, "walkers": 0, "weather": True, **space}
    assert not placed(content, catalogues)


def test_notes_on_scenarios_and_agents_have_their_place_in_the_campaign(
    content: dict[str, Any], catalogues: Catalogues
) -> None:
    content["scenario"]["ego_vehicles"][0]["initial_speed"] = 50.0
    content["agent"] = {"name": "scripted", "parameters": {"speed": 60.0}}
    agent, start = placed(content, catalogues)
    assert agent.startswith("/agent/parameters/speed: 60, in m/s 216 km/h")
    assert start.startswith("/scenario/ego_vehicles/0/initial_speed: ego ")
    slow = copy.deepcopy(content["scenario"])
    slow["ego_vehicles"][0]["initial_speed"] = 5.0
    content["scenarios"] = [
        {"name": "slow", "scenario": slow},
        {"name": "fast", "scenario": content.pop("scenario")},
    ]
    _, start = placed(content, catalogues)
    assert start.startswith("/scenarios/1/scenario/ego_vehicles/0/initial_speed: ego ")


def test_parameters_of_an_agent_that_does_not_drive_are_not_noted(
    content: dict[str, Any], catalogues: Catalogues
) -> None:
    own = {"name": "scripted", "parameters": {"speed": 60.0}}
    content["scenario"]["ego_vehicles"][0]["agent"] = own
    content["agent"] = {"name": "idm"}
    assert not placed(content, catalogues)
