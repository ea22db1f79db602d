"""Going first where another has the right of way."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np
import pytest
from shapely import LineString

from drivora_service.observations.trace import Col, Role
from drivora_service.oracles.failure_to_yield import FailureToYield
from drivora_service.oracles.verdict import Outcome, Severity, Verdict
from drivora_service.testing.traces import Motion, SyntheticActor
from tests.oracles.streets import DT, along, judge_on, on_network, steady, way
from tests.simulation.episodes import network

TOWN = network("tee-town")
MINOR, LEFT = "-church_1_0", "high_3_0"
"""Out of the side road to the left: vehicles on ``-high_3`` and ``high_2`` go first."""
MAJOR = ("-high_3_0", "-high_2_0")
STEPS = 500


def other(fronts: np.ndarray, lanes: Sequence[str] = MAJOR, name: str = "other") -> SyntheticActor:
    return SyntheticActor(motion=along(way(TOWN, *lanes), fronts), id=name)


def judge(
    ego_fronts: np.ndarray, *others: SyntheticActor, lanes: Sequence[str] = (MINOR, LEFT)
) -> tuple[Verdict, ...]:
    ego = on_network(TOWN, along(way(TOWN, *lanes), ego_fronts))
    return judge_on(TOWN, FailureToYield(), ego, others=others)


def meeting(seconds_later: float, speed: float = 8.0) -> np.ndarray:
    """The other's front, at the ego's junction some seconds after an ego at 8 m/s."""
    ego_arrives = (float(TOWN.lane(MINOR).arc[-1]) - 6.0) / 8.0
    own = float(TOWN.lane(MAJOR[0]).arc[-1])
    return own + speed * (DT * np.arange(STEPS) - ego_arrives - seconds_later)


def test_pulling_out_close_before_another_is_a_failure_to_yield() -> None:
    (verdict,) = judge(steady(8.0, STEPS), other(meeting(1.3)))
    assert verdict.outcome is Outcome.VIOLATED
    assert verdict.severity is Severity.MAJOR
    assert verdict.at_fault
    assert verdict.counterpart == "other"
    assert verdict.evidence["place"] == "junction"
    assert 0.0 <= verdict.evidence["encroachment"] < 1.0


@pytest.mark.parametrize("seconds", [-3.0, 6.0])
def test_going_behind_another_or_long_before_it_is_none(seconds: float) -> None:
    (verdict,) = judge(steady(8.0, STEPS), other(meeting(seconds)))
    assert verdict.outcome is Outcome.PASSED


def test_the_ego_with_the_right_of_way_gives_nothing_to_judge() -> None:
    minor = SyntheticActor(motion=along(way(TOWN, MINOR, LEFT), steady(8.0, STEPS)))
    (verdict,) = judge(meeting(1.3), minor, lanes=MAJOR)
    assert verdict.outcome is Outcome.NOT_APPLICABLE
    assert verdict.evidence["conflicts"] == 0


def braking_for_the_ego(braking: float, begins: float) -> np.ndarray:
    """The other's front: at 12 m/s it would meet the ego, and brakes to 4 m/s before."""
    ego_arrives = (float(TOWN.lane(MINOR).arc[-1]) - 6.0) / 8.0
    begins += ego_arrives
    times = DT * np.arange(STEPS)
    slowing = np.clip(times - begins, 0.0, 8.0 / braking)
    speeds = 12.0 - braking * slowing
    driven = np.concatenate(([0.0], np.cumsum(0.5 * (speeds[1:] + speeds[:-1]) * DT)))
    return float(TOWN.lane(MAJOR[0]).arc[-1]) - 12.0 * (ego_arrives + 1.5) + driven


def braked(fronts: np.ndarray) -> Motion:
    """A vehicle that brakes, with the acceleration that its speeds show."""
    motion = along(way(TOWN, *MAJOR), fronts)
    for speed, acceleration in ((Col.VX, Col.AX), (Col.VY, Col.AY)):
        motion.states[:, acceleration] = np.gradient(motion.states[:, speed], DT)
    return motion


@pytest.mark.parametrize(
    ("braking", "begins", "outcome"),
    [(6.0, 0.0, Outcome.VIOLATED), (2.0, -3.0, Outcome.PASSED)],
)
def test_making_another_brake_hard_is_a_failure(
    braking: float, begins: float, outcome: Outcome
) -> None:
    motion = braked(braking_for_the_ego(braking, begins))
    (verdict,) = judge(steady(8.0, STEPS), SyntheticActor(motion=motion))
    assert verdict.outcome is outcome
    if outcome is Outcome.VIOLATED:
        assert verdict.evidence["braking"] == pytest.approx(braking, abs=0.1)
        assert verdict.evidence["encroachment"] > 1.0
        assert verdict.time is not None
        assert verdict.evidence["braked_at"] > verdict.time


def test_braking_for_a_third_vehicle_is_none_of_the_egos() -> None:
    fronts = braking_for_the_ego(6.0, 0.0)
    ahead = SyntheticActor(motion=along(way(TOWN, *MAJOR), fronts + 15.0), id="ahead")
    verdicts = judge(steady(8.0, STEPS), SyntheticActor(motion=braked(fronts), id="other"), ahead)
    assert "other" not in {verdict.counterpart for verdict in verdicts}


def test_braking_far_away_is_none_of_the_egos() -> None:
    """The other brakes 60 m away: at its speed it would have come 5 s after the ego."""
    motion = braked(braking_for_the_ego(6.0, 0.0) - 60.0)
    (verdict,) = judge(steady(8.0, STEPS), SyntheticActor(motion=motion))
    assert verdict.outcome is Outcome.PASSED


def test_who_goes_first_at_an_all_way_stop_is_not_judged() -> None:
    lanes = ("-market_2_0", "-market_1_0")
    arrives = (float(TOWN.lane(lanes[0]).arc[-1]) - 6.0) / 8.0
    crossing = ("market_1_0", "orchard_1_0")
    own = float(TOWN.lane(crossing[0]).arc[-1])
    foe = other(own + 8.0 * (DT * np.arange(STEPS) - arrives - 1.0), crossing)
    (verdict,) = judge(steady(8.0, STEPS), foe, lanes=lanes)
    assert verdict.outcome is Outcome.PASSED


GRID = network("signal-grid")
FROM, TO = "-bridge_3_2", "queen_3_1"
ONCOMING = ("bridge_2_1", "bridge_3_1")


@pytest.mark.parametrize(
    ("own", "theirs", "outcome"),
    [
        ("g", "G", Outcome.VIOLATED),
        ("G", "G", Outcome.PASSED),
        ("g", "r", Outcome.NOT_APPLICABLE),
    ],
)
def test_a_left_turn_on_green_yields_to_oncoming_green(
    own: str, theirs: str, outcome: Outcome
) -> None:
    ego_line, foe_line = way(GRID, FROM, TO), way(GRID, *ONCOMING)
    arrives = (float(GRID.lane(FROM).arc[-1]) - 6.0) / 8.0
    foe_fronts = float(GRID.lane(ONCOMING[0]).arc[-1]) + 8.0 * (
        DT * np.arange(STEPS) - arrives - 1.5
    )
    count = len(GRID.programs["c3"].phases[0].state)
    (mine,) = (c for c in GRID.lane(FROM).connections if c.direction == "l")
    letters = [theirs] * count
    letters[mine.link_index] = own
    (verdict,) = judge_on(
        GRID,
        FailureToYield(),
        on_network(GRID, along(ego_line, steady(8.0, STEPS))),
        others=[SyntheticActor(motion=along(foe_line, foe_fronts))],
        lights={"c3": ["".join(letters)] * STEPS},
    )
    assert verdict.outcome is outcome


def crossing_walker(later: float) -> tuple[np.ndarray, Motion, str, int]:
    """An ego's line over a signalised crossing, and a walker on it some seconds after the ego."""
    line = way(GRID, FROM, TO)
    area, entry = next(
        (GRID.lanes[connection.to_lane], connection)
        for lane in GRID.lanes
        for connection in lane.connections
        if re.match(r":c3_c\d", GRID.lanes[connection.to_lane].id)
        and connection.traffic_light
        and LineString(GRID.lanes[connection.to_lane].shape).intersects(LineString(line))
    )
    start, end = area.shape[0], area.shape[-1]
    return line, _walk(line, start, end, later), entry.traffic_light, entry.link_index


def _walk(line: np.ndarray, start: np.ndarray, end: np.ndarray, later: float) -> Motion:
    heading = (end - start) / np.hypot(*(end - start))
    across = (line - start) @ np.array([-heading[1], heading[0]])
    nearest = int(np.argmin(np.abs(across)))
    meets = float((line[nearest] - start) @ heading)
    arrives = (float(np.hypot(*np.diff(line[: nearest + 1], axis=0).T).sum()) - 6.0) / 8.0
    s = meets + 1.5 * (DT * np.arange(STEPS) - arrives - later)
    s = np.clip(s, 0.1, float(np.hypot(*(end - start))))
    return Motion.along(start[0] + s * heading[0], start[1] + s * heading[1])


@pytest.mark.parametrize(
    ("later", "letter", "outcome"),
    [(1.6, "G", Outcome.VIOLATED), (1.6, "r", Outcome.PASSED), (-4.0, "G", Outcome.PASSED)],
)
def test_walkers_on_a_green_crossing_go_first(later: float, letter: str, outcome: Outcome) -> None:
    line, motion, light, link = crossing_walker(later)
    walker = SyntheticActor(motion=motion, id="walker", role=Role.NPC_WALKER, length=0.6, width=0.6)
    count = len(GRID.programs[light].phases[0].state)
    letters = ["g"] * count
    letters[link] = letter
    ego = on_network(GRID, along(line, steady(8.0, STEPS)))
    (verdict,) = judge_on(
        GRID, FailureToYield(), ego, others=[walker], lights={light: ["".join(letters)] * STEPS}
    )
    assert verdict.outcome is outcome
    if outcome is Outcome.VIOLATED:
        assert verdict.evidence["place"] == "crossing"
        assert verdict.counterpart == "walker"


@pytest.mark.parametrize(
    ("letter", "outcome"), [("G", Outcome.PASSED), ("r", Outcome.NOT_APPLICABLE)]
)
def test_a_crossing_without_walkers_is_judged_if_they_would_go_first(
    letter: str, outcome: Outcome
) -> None:
    line, _, light, link = crossing_walker(1.0)
    # All vehicles have red.
    letters = ["r"] * len(GRID.programs[light].phases[0].state)
    letters[link] = letter
    ego = on_network(GRID, along(line, steady(8.0, STEPS)))
    (verdict,) = judge_on(GRID, FailureToYield(), ego, lights={light: ["".join(letters)] * STEPS})
    assert verdict.outcome is outcome


def test_waiting_at_the_line_of_a_minor_road_is_giving_way() -> None:
    line = float(TOWN.lane(MINOR).arc[-1])
    (verdict,) = judge(np.minimum(steady(8.0, STEPS), line - 1.0))
    assert verdict.outcome is Outcome.PASSED
    (verdict,) = judge(np.minimum(steady(8.0, STEPS), line - 20.0))
    assert verdict.outcome is Outcome.NOT_APPLICABLE
