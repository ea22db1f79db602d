"""What SUMO refuses is an error of the project, and the process goes on."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from drivora_service.errors import SimulatorError
from drivora_service.observations.trace import TerminalEvent
from drivora_service.simulation.sumo import SumoWorld
from tests.simulation.episodes import ROAD, ego, network, place, run, scenario


@pytest.mark.parametrize("text", ["", "<net"])
def test_a_network_that_sumo_refuses(tmp_path: Path, text: str) -> None:
    broken = tmp_path / "broken.net.xml"
    broken.write_text(text)
    for path in (broken, tmp_path / "absent.net.xml"):
        with pytest.raises(SimulatorError, match=path.name):
            SumoWorld(path, step_length=0.05, seed=0, slippery=False).open()
    what = scenario(ego(place(ROAD, 10), place(ROAD, 60)), seconds=20.0)
    assert run(what).ego_ends == (TerminalEvent.ARRIVED,)


def test_a_route_that_sumo_refuses() -> None:
    world = SumoWorld(network().path, step_length=0.05, seed=0, slippery=False)
    world.open()
    with pytest.raises(SimulatorError, match="'lost'"):
        world.add_driven(
            0, "lost", ["nowhere"], driver="krauss-LC2013", length=4.5, width=1.8,
            lane_number=0, position=10.0, arrival=None,
        )  # fmt: skip
    world.step()
    assert "lost" not in world.known_ids()


def test_who_stands_at_the_end_of_its_route_does_not_leave_the_road() -> None:
    world = SumoWorld(network().path, step_length=0.05, seed=0, slippery=False)
    world.open()
    lane = network().lane(ROAD)
    x, y, yaw = lane.position_at(float(lane.arc[-1]) - 0.02)
    actor = world.add_moved(
        0, "waits", [lane.edge_id], length=4.5, width=1.8, is_walker=False, follows_route=True
    )
    angle = 90.0 - math.degrees(yaw)
    for step in range(30):
        moves = 1.0 if step in (0, 25) else 0.0
        world.place([actor], [[x, y, angle, moves]])
        world.step()
    assert "waits" in world.known_ids()
