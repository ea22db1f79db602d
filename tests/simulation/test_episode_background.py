"""The background traffic of a document acts in an episode."""

from __future__ import annotations

import numpy as np

from drivora_service.observations.trace import Col, Role
from drivora_service.scenario.model import (
    BackgroundTraffic,
    MapRegion,
    Region,
)
from tests.simulation.episodes import (
    ROAD,
    Watching,
    ego,
    network,
    parked,
    place,
    presence,
    run,
    scenario,
    standing,
    travelled,
)


def test_background_traffic_keeps_its_size_from_its_start_time_on() -> None:
    what = scenario(
        parked(), background_traffic=BackgroundTraffic(count=12, start_time=2.0), seconds=40.0
    )
    trace = run(what, standing())
    rows = [a.row for a in trace.actors if a.role is Role.BACKGROUND]
    count = trace.present[:, rows].sum(axis=1)
    assert np.all(count[:40] == 0)
    assert np.all(count[60:] >= 11)
    assert np.median(count[60:]) == 12
    moving = [travelled(trace, trace.actors[row].id) for row in rows]
    assert np.median(moving) > 50.0


def test_no_background_vehicle_enters_at_an_egos_start() -> None:
    spot = place(ROAD, 60)
    for seed in range(3):
        what = scenario(
            ego(spot, place(ROAD, 120)),
            background_traffic=BackgroundTraffic(count=60), seed=seed, seconds=0.3,
        )  # fmt: skip
        trace = run(what, standing())
        others = trace.states[1, 1:, :2]
        assert np.nanmin(np.hypot(*(others - (spot.x, spot.y)).T)) > 12.0
        assert not trace.contacts


def test_background_traffic_enters_inside_the_region_only() -> None:
    region = Region(min_x=-20.0, max_x=200.0, min_y=200.0, max_y=420.0)
    what = scenario(
        ego(place("-west_1_0", 20), place("-west_1_0", 100)),
        map_region=MapRegion(town="tee-town", region_segment=region),
        background_traffic=BackgroundTraffic(count=10), seconds=20.0,
    )  # fmt: skip
    trace = run(what, standing())
    entered = 0
    for actor in trace.actors[1:]:
        here = presence(trace, actor.id)
        first = np.flatnonzero(here & ~np.concatenate(([False], here[:-1])))
        for k in first:
            x, y = trace.states[k, actor.row, :2]
            # The front bumper enters inside; the centre is behind it.
            assert -23.0 < x < 203.0
            assert 197.0 < y < 423.0
            entered += 1
    assert entered >= 10


def test_background_traffic_stops_behind_a_standing_ego_and_the_ego_sees_it() -> None:
    eye = Watching()
    lane = network().lane(ROAD)
    what = scenario(
        ego(place(ROAD, 100), place(ROAD, 120)),
        background_traffic=BackgroundTraffic(count=50), seed=4, seconds=60.0,
    )  # fmt: skip
    trace = run(what, eye)
    assert not trace.contacts
    spot = np.array(lane.position_at(100.0)[:2])
    back = np.array(lane.position_at(80.0)[:2])
    queue = trace.states[-1, 1:]
    behind = np.hypot(*(queue[:, :2] - back).T) < 14.0
    heading = np.cos(queue[:, Col.YAW] - lane.position_at(80.0)[2]) > 0.9
    assert (behind & heading & (np.hypot(queue[:, Col.VX], queue[:, Col.VY]) < 0.1)).any()
    assert any(len(objects) for objects in eye.seen)
    nearest = min(np.hypot(*(o[:, :2] - spot).T).min() for o in eye.seen if len(o))
    assert nearest < 12.0
