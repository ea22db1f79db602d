"""Standing before a stop sign, or not."""

from __future__ import annotations

import numpy as np
import pytest

from drivora_service.observations.trace import Col
from drivora_service.oracles.stop_sign import StopSign
from drivora_service.oracles.verdict import Outcome, Severity, Verdict
from tests.oracles.streets import along, judge_on, on_network, steady, way
from tests.simulation.episodes import network

TOWN = network("tee-town")
ALL_WAY_STOP, BEHIND = "-market_2_0", "-market_1_0"
LINE = float(TOWN.lane(ALL_WAY_STOP).arc[-1])


def drive(fronts: np.ndarray, **fields: object) -> Verdict:
    ego = on_network(TOWN, along(way(TOWN, ALL_WAY_STOP, BEHIND), fronts), **fields)
    (verdict,) = judge_on(TOWN, StopSign(), ego)
    return verdict


def pausing(before: float, seconds: float, *, creep: float = 0.0) -> np.ndarray:
    """Comes on at 8 m/s, stands ``before`` metres before the line, and goes on."""
    until = np.arange(LINE - 40.0, LINE - before, 0.4)
    rest = until[-1] + creep * 0.05 * np.arange(1, round(seconds / 0.05) + 1)
    return np.concatenate((until, rest, rest[-1] + 0.4 * np.arange(1, 100)))


@pytest.mark.parametrize(
    ("before", "seconds", "outcome"),
    [
        (1.0, 1.0, Outcome.PASSED),
        (3.4, 1.0, Outcome.PASSED),
        (4.6, 1.0, Outcome.VIOLATED),
        (1.0, 0.4, Outcome.VIOLATED),
    ],
)
def test_the_ego_must_stand_before_the_line(
    before: float, seconds: float, outcome: Outcome
) -> None:
    verdict = drive(pausing(before, seconds))
    assert verdict.outcome is outcome
    if outcome is Outcome.VIOLATED:
        assert verdict.at_fault
        assert verdict.severity is Severity.MAJOR
        assert verdict.location is not None
        end = TOWN.lane(ALL_WAY_STOP).shape[-1]
        assert np.hypot(*(np.array(verdict.location) - end)) == pytest.approx(2.25, abs=0.5)


@pytest.mark.parametrize(("creep", "outcome"), [(0.05, Outcome.PASSED), (0.3, Outcome.VIOLATED)])
def test_creeping_on_is_no_stop(creep: float, outcome: Outcome) -> None:
    assert drive(pausing(2.0, 3.0, creep=creep)).outcome is outcome


def test_what_counts_is_the_place_and_not_the_recorded_speed() -> None:
    motion = along(way(TOWN, ALL_WAY_STOP, BEHIND), steady(8.0, 300))
    motion.states[:, [Col.VX, Col.VY]] = 0.0
    motion.states[0, Col.VX] = 8.0
    (verdict,) = judge_on(TOWN, StopSign(), on_network(TOWN, motion))
    assert verdict.outcome is Outcome.VIOLATED
    assert verdict.evidence["slowest"] == pytest.approx(8.0, abs=0.5)


def test_off_its_route_the_sign_stands_as_well() -> None:
    assert drive(steady(8.0, 400), route_lateral=25.0).outcome is Outcome.VIOLATED


def test_a_minor_road_has_no_stop_sign() -> None:
    fronts = steady(8.0, 500)
    ego = on_network(TOWN, along(way(TOWN, "-church_1_0", "high_3_0"), fronts))
    (verdict,) = judge_on(TOWN, StopSign(), ego)
    assert verdict.outcome is Outcome.NOT_APPLICABLE
    assert verdict.message == "No stop sign on the way."
    assert verdict.evidence["lines"] == 0


@pytest.mark.parametrize(
    ("letter", "outcome"), [("s", Outcome.VIOLATED), ("g", Outcome.NOT_APPLICABLE)]
)
def test_a_signal_may_ask_for_a_stop(letter: str, outcome: Outcome) -> None:
    grid = network("signal-grid")
    count = len(grid.programs["c3"].phases[0].state)
    ego = on_network(grid, along(way(grid, "-bridge_3_2", "-bridge_2_2"), steady(10.0, 400)))
    (verdict,) = judge_on(grid, StopSign(), ego, lights={"c3": [letter * count] * 400})
    assert verdict.outcome is outcome


def test_waiting_at_the_sign_until_the_end_is_something_to_judge() -> None:
    assert drive(np.minimum(steady(8.0, 300), LINE - 1.0)).outcome is Outcome.PASSED
    assert drive(np.minimum(steady(8.0, 300), LINE - 20.0)).outcome is Outcome.NOT_APPLICABLE
